"""How a tap proves itself to an OPC UA server: policy, certificate, key, user."""

from contextlib import suppress
from pathlib import Path
from typing import Any

from asyncua.client.client import Client
from asyncua.crypto import security_policies, uacrypto
from asyncua.ua import MessageSecurityMode
from asyncua.ua.status_codes import StatusCodes
from cryptography import x509

from runglight.errors import InputError
from runglight.nearest import suggestion
from runglight.taps.url import SourceUrl

POLICIES: dict[str, Any] = {
    "Basic256Sha256": security_policies.SecurityPolicyBasic256Sha256,
    "Aes128Sha256RsaOaep": security_policies.SecurityPolicyAes128Sha256RsaOaep,
    "Aes256Sha256RsaPss": security_policies.SecurityPolicyAes256Sha256RsaPss,
}
REFUSALS = (
    StatusCodes.BadUserAccessDenied,
    StatusCodes.BadIdentityTokenInvalid,
    StatusCodes.BadIdentityTokenRejected,
    StatusCodes.BadSecurityPolicyRejected,
    StatusCodes.BadSecurityModeRejected,
    StatusCodes.BadCertificateUntrusted,
    StatusCodes.BadCertificateInvalid,
)
"""What a server answers to someone it will not let in."""


def check_security(url: SourceUrl) -> None:
    """InputError where the security options of a URL cannot work."""
    policy = url.options.get("security", "none")
    files = [option for option in ("certificate", "key") if option in url.options]
    if policy.lower() == "none":
        if files:
            raise InputError(f"{url.text}: {files[0]} needs security=Basic256Sha256 with it")
        return
    if policy not in POLICIES:
        near = suggestion(policy, POLICIES) or f"; there are: none, {', '.join(POLICIES)}"
        raise InputError(f"{url.text}: no security policy is called {policy!r}{near}")
    for option in ("certificate", "key"):
        if option not in url.options:
            raise InputError(
                f"{url.text}: security={policy} needs {option}=FILE (.pem or .der) as well"
            )
    for option in ("certificate", "key", "server_certificate"):
        if option in url.options and not Path(url.options[option]).is_file():
            raise InputError(f"{url.text}: {option}: there is no file {url.options[option]}")


async def secure(client: Client, url: SourceUrl) -> None:
    """Sets user, policy and certificates of a client that is not connected yet."""
    if url.username is not None:
        client.set_user(url.username)
        client.set_password(url.password or "")
    policy = POLICIES.get(url.options.get("security", "none"))
    if policy is not None:
        # Servers refuse a client that calls itself otherwise than its certificate does.
        certificate = await uacrypto.load_certificate(Path(url.options["certificate"]))
        with suppress(x509.ExtensionNotFound, IndexError):
            names = certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName)
            uris = names.value.get_values_for_type(x509.UniformResourceIdentifier)
            client.application_uri = uris[0]
        await client.set_security(
            policy,
            certificate=url.options["certificate"],
            private_key=url.options["key"],
            server_certificate=url.options.get("server_certificate"),
            mode=MessageSecurityMode.SignAndEncrypt,
        )
