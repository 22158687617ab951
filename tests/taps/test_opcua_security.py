"""Signed and encrypted, with a user: asyncua's server asks for all of it."""

import asyncio
from pathlib import Path

import pytest
from asyncua import Server, ua
from asyncua.crypto.cert_gen import (
    dump_private_key_as_pem,
    generate_private_key,
    generate_self_signed_app_certificate,
)
from asyncua.crypto.permission_rules import SimpleRoleRuleset, User, UserRole
from cryptography.hazmat.primitives.serialization import Encoding
from cryptography.x509 import UniformResourceIdentifier
from cryptography.x509.oid import ExtendedKeyUsageOID

from runglight.errors import InputError
from runglight.taps import open_tap
from tests.taps.benches.opcua import OpcUaBench
from tests.taps.listening import Listener

CLIENT_URI = "urn:runglight:test:client"


def certificate(directory: Path, name: str, uri: str) -> tuple[Path, Path]:
    """A self-signed certificate and its key, as files."""
    key = generate_private_key()
    signed = generate_self_signed_app_certificate(
        key,
        name,
        {"organizationName": "runglight"},
        [UniformResourceIdentifier(uri)],
        extended=[ExtendedKeyUsageOID.CLIENT_AUTH, ExtendedKeyUsageOID.SERVER_AUTH],
    )
    files = directory / f"{name}.der", directory / f"{name}.pem"
    files[0].write_bytes(signed.public_bytes(Encoding.DER))
    files[1].write_bytes(dump_private_key_as_pem(key))
    return files


class Users:
    def get_user(
        self,
        iserver: object,
        username: str | None = None,
        password: str | None = None,
        certificate: object = None,
    ) -> User | None:
        return User(UserRole.User) if (username, password) == ("tapper", "se:cret") else None


class SecuredBench(OpcUaBench):
    def __init__(self, directory: Path) -> None:
        super().__init__()
        self._files = certificate(directory, "server", "urn:runglight:server")

    async def more(self, server: Server) -> None:
        await server.set_application_uri("urn:runglight:server")
        server.set_security_policy(
            [ua.SecurityPolicyType.Basic256Sha256_SignAndEncrypt],
            permission_ruleset=SimpleRoleRuleset(),
        )
        server.iserver.user_manager = Users()
        await server.load_certificate(str(self._files[0]))
        await server.load_private_key(str(self._files[1]))


def test_encrypted_with_user_and_password(tmp_path: Path) -> None:
    pem, key = certificate(tmp_path, "client", CLIENT_URI)

    async def test() -> None:
        bench = SecuredBench(tmp_path)
        await bench.start()
        try:
            secured = f"security=Basic256Sha256&certificate={pem}&key={key}&timeout=5"
            host = f"127.0.0.1:{bench.port}/line"
            tap = open_tap(f"opcua://tapper:se%3Acret@{host}?{secured}")
            assert "cret" not in tap.url
            async with Listener(tap) as listener:
                await listener.until(lambda: listener.images)
                assert listener.images[0] == {"Station-Clamp": 0, "Station-Step": 0}
                await bench.put("Station-Step", 3)
                await listener.until(lambda: listener.changes("Station-Step") == [3])
            async with open_tap(f"opcua://tapper:wrong@{host}?{secured}") as stranger:
                with pytest.raises(InputError, match="lets us not in"):
                    async for _ in stranger:
                        pass
        finally:
            await bench.kill()

    asyncio.run(test())
