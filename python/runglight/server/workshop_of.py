"""The workshop a request is answered from."""

from starlette.requests import Request

from runglight.server.workshop import Workshop


def workshop_of(request: Request) -> Workshop:
    """Put there by `application`."""
    workshop = request.app.state.workshop
    assert isinstance(workshop, Workshop)
    return workshop
