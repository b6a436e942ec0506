"""The command ``submit``: a part on a server."""

from __future__ import annotations

from service.cli.documents import named
from service.cli.models import read_definition
from service.cli.options import File, Json, Note, Private, Server, Wait, with_server
from service.cli.output import print_json, tell_warnings, waiting
from service.cli.progress import became_job


@with_server
def submit(
    server: Server, file: File, note: Note = "", private: Private = False, wait: Wait = True, json: Json = False
) -> int:
    """Submit a definition to a server, which derives, verifies and stores it."""
    document = read_definition(file)
    if isinstance(document, dict):
        document |= {"note": note} if note else {}
        document |= {"visibility": "private"} if private else {}
    with server.client() as client:
        with waiting("deriving"), named(file):
            answer = client.request("POST", "/v1/substructures", document)
        version = answer.json()
        if answer.status_code == 202:
            return became_job(client, version, wait, json)
    if json:
        print_json(version)
        return 0
    stored = "stored" if answer.status_code == 201 else "was stored already"
    print(f"{version['name']}@{version['version']} {stored}, {version['digest']}")
    tell_warnings(version)
    return 0


COMMANDS = {"submit": submit}
