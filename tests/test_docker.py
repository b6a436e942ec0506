"""The files in ``docker/``: what they promise is checked by reading them; the steps of the image are replayed."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import socket
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
import yaml

from service import __version__
from service.cli.main import main
from service.settings import from_environment

ROOT = Path(__file__).parents[1]
DOCKERFILE = ROOT / "docker" / "Dockerfile"
COMPOSE: dict[str, Any] = yaml.safe_load((ROOT / "docker" / "compose.yaml").read_text())
SERVICES: dict[str, dict[str, Any]] = COMPOSE["services"]
OURS = ("service", "scheduler", "worker")
PINNED = re.compile(r"[a-z]+:[0-9]+\.[0-9]+(\.[0-9]+)?(-[a-z]+)*")
REFERENCE = re.compile(r"\$\{[A-Z_]+:\?[^}]+\}")


@dataclass(frozen=True)
class Step:
    """An instruction of the Dockerfile."""

    name: str
    text: str


def steps() -> list[Step]:
    """The instructions, continued lines joined, without comments."""
    lines = [line for line in DOCKERFILE.read_text().splitlines() if not line.startswith("#")]
    joined = re.sub(r"\\\n\s*", " ", "\n".join(lines))
    return [Step(*line.split(" ", 1)) for line in joined.splitlines() if line.strip()]


def given(name: str) -> list[str]:
    return [step.text for step in steps() if step.name == name]


def stages() -> list[list[Step]]:
    result: list[list[Step]] = []
    for step in steps():
        if step.name == "FROM":
            result.append([])
        result[-1].append(step)
    return result


def test_every_instruction_is_known() -> None:
    known = {"FROM", "WORKDIR", "COPY", "RUN", "ENV", "USER", "VOLUME", "EXPOSE", "HEALTHCHECK", "CMD"}
    assert {step.name for step in steps()} <= known


def test_image_is_pinned_and_slim() -> None:
    images = [text.split(" ")[0] for text in given("FROM")]
    assert len(set(images)) == 1
    assert PINNED.fullmatch(images[0])
    assert "-slim" in images[0]


def test_image_does_not_run_as_root_and_looks_after_its_health() -> None:
    final = stages()[-1]
    (user,) = (step.text for step in final if step.name == "USER")
    assert user.isdigit()
    assert int(user) > 0
    names = [step.name for step in final]
    assert names.index("USER") < names.index("CMD")
    assert not {"COPY", "RUN"} & set(names[names.index("USER") :])
    (health,) = given("HEALTHCHECK")
    assert "/livez" in health
    (command,) = given("CMD")
    assert json.loads(command) == ["substructures", "serve"]


def test_everything_the_image_writes_is_on_the_volume() -> None:
    assert given("VOLUME") == ["/data"]
    (environment,) = given("ENV")
    paths = re.findall(r"SUBSTRUCTURES_[A-Z]+=(?:sqlite:///)?(/\S+)", environment)
    assert len(paths) == 2
    assert all(path.startswith("/data/") for path in paths)


def test_image_takes_from_the_repository_what_it_needs_and_no_more() -> None:
    sources = [shlex.split(text)[:-1] for text in given("COPY") if not text.startswith("--from")]
    copied = {name for names in sources for name in names}
    ignored = (ROOT / "docker" / "Dockerfile.dockerignore").read_text().split()
    assert ignored[0] == "*"
    assert {line[1:] for line in ignored if line.startswith("!")} == copied
    assert all((ROOT / name).exists() for name in copied)


def test_no_secret_is_in_the_files() -> None:
    for path in (ROOT / "docker").iterdir():
        for name, value in re.findall(r"(\w*(?:PASSWORD|SECRET|TOKEN|_KEY))\s*[=:]\s+(\S+)", path.read_text()):
            assert value.startswith(("${", "...")), (path.name, name)
    for name, service in SERVICES.items():
        for key, value in service.get("environment", {}).items():
            if "PASSWORD" in key or "@" in value:
                assert REFERENCE.search(value), (name, key)


@pytest.mark.parametrize("name", SERVICES)
def test_every_container_is_locked_down(name: str) -> None:
    service = SERVICES[name]
    assert PINNED.fullmatch(service["image"])
    assert service["read_only"] is True
    assert service["cap_drop"] == ["ALL"]
    assert "no-new-privileges:true" in service["security_opt"]
    assert service["restart"] == "unless-stopped"
    assert Path("/", "tmp").as_posix() in service["tmpfs"]
    assert name == "service" or "healthcheck" in service
    assert service.get("user", "10001") not in ("root", "0")
    named = [volume.split(":")[0] for volume in service.get("volumes", [])]
    assert set(named) <= COMPOSE["volumes"].keys()
    assert len(named) == (1 if name in ("service", "postgres") else 0)


def test_image_of_the_containers_is_the_one_built_here() -> None:
    for name in OURS:
        assert SERVICES[name]["image"] == f"substructures:{__version__}"
        build = SERVICES[name]["build"]
        assert (ROOT / "docker" / build["context"] / build["dockerfile"]).samefile(DOCKERFILE)


def test_only_the_service_is_reached_from_outside_and_only_on_loopback() -> None:
    published = {name: service["ports"] for name, service in SERVICES.items() if "ports" in service}
    assert published == {"service": ["127.0.0.1:8000:8000"]}
    assert given("EXPOSE") == ["8000"]
    assert COMPOSE["networks"]["inside"]["internal"] is True
    assert all(SERVICES[name]["networks"] == ["inside"] for name in SERVICES if name != "service")


def test_what_computes_knows_nothing_of_the_database() -> None:
    assert all("environment" not in SERVICES[name] for name in ("scheduler", "worker"))
    environment = SERVICES["service"]["environment"]
    assert environment["SUBSTRUCTURES_ENGINE"] == "dask"
    command = SERVICES["scheduler"]["command"]
    assert environment["SUBSTRUCTURES_ENGINE_ADDRESS"] == f"tcp://scheduler:{command[command.index('--port') + 1]}"
    assert environment["SUBSTRUCTURES_ENGINE_ADDRESS"] in SERVICES["worker"]["command"]


KUBERNETES = [
    document
    for name in ("kubernetes.yaml", "kubernetes-night.yaml")
    for document in yaml.safe_load_all((ROOT / "docker" / name).read_text())
]


@pytest.mark.parametrize("kind", ["Deployment", "Job"])
def test_pods_are_locked_down_and_of_the_image(kind: str) -> None:
    (document,) = [each for each in KUBERNETES if each["kind"] == kind]
    pod = document["spec"]["template"]["spec"]
    (container,) = pod["containers"]
    assert container["image"] == f"substructures:{__version__}"
    assert pod["securityContext"]["runAsNonRoot"] is True
    assert [str(pod["securityContext"]["runAsUser"])] == given("USER")
    assert pod["automountServiceAccountToken"] is False
    rights = container["securityContext"]
    assert (rights["readOnlyRootFilesystem"], rights["allowPrivilegeEscalation"]) == (True, False)
    assert rights["capabilities"] == {"drop": ["ALL"]}
    mounted = {each["name"]: each["mountPath"] for each in container["volumeMounts"]}
    assert mounted.keys() == {each["name"] for each in pod["volumes"]}
    assert {"/data", "/tmp", "/keys"} == set(mounted.values())  # noqa: S108 -- of the container
    environment = {each["name"]: each for each in container["env"]}
    assert "valueFrom" in environment.pop("SUBSTRUCTURES_DATABASE")
    settings = {name: each["value"] for name, each in environment.items()}
    assert from_environment(settings).seal_key.startswith(mounted["keys"])


def test_the_service_of_the_cluster_is_that_of_the_pods() -> None:
    found = {each["kind"]: each for each in KUBERNETES}
    pods = found["Deployment"]["spec"]["template"]
    assert found["Service"]["spec"]["selector"] == pods["metadata"]["labels"]
    (container,) = pods["spec"]["containers"]
    assert {"containerPort": found["Service"]["spec"]["ports"][0]["port"]} in container["ports"]
    assert "metadata" in found["Job"]
    assert found["Job"]["spec"]["template"]["spec"]["restartPolicy"] == "OnFailure"


def test_commands_of_clusters_are_those_of_the_command_line() -> None:
    script = (ROOT / "docker" / "night.sbatch").read_text()
    subprocess.run(["bash", "-n"], input=script, text=True, check=True)  # noqa: S607 -- the shell that there is
    commands = [re.sub(r"^srun ", "", script.splitlines()[-1]).replace('"$SLURM_CPUS_PER_TASK"', "8").split()]
    pods = [each["spec"]["template"]["spec"] for each in KUBERNETES if "template" in each["spec"]]
    commands += [pod["containers"][0]["args"] for pod in pods]
    assert [words[:2] for words in commands] == [["substructures", name] for name in ("worker", "serve", "worker")]
    for _, name, *options in commands:
        # click reads the options, and --help after them ends it
        assert main([name, *options, "--help"]) == 0


class Replay:
    """The steps of the image below a directory that stands for the root of its file system."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.directory = root
        self.environment = {
            name: x for name, x in os.environ.items() if not name.startswith(("SUBSTRUCTURES", "PYTHON"))
        }

    def here(self, text: str) -> str:
        """Paths of the image as they are below the root."""
        return re.sub(r"(?<![\w.])/(opt/substructures|data|source)\b", rf"{self.root}/\1", text)

    def play(self, step: Step) -> None:
        match step.name:
            case "WORKDIR":
                self.directory = Path(self.here(step.text))
                self.directory.mkdir(parents=True, exist_ok=True)
            case "COPY" if not step.text.startswith("--from"):
                *names, target = shlex.split(step.text)
                for name in names:
                    self.copy(ROOT / name, self.directory / target)
            case "RUN":
                self.run(step.text)
            case "ENV":
                for name, value in re.findall(r"(\w+)=(\S+)", step.text):
                    self.environment[name] = self.here(value).replace("$PATH", self.environment["PATH"])
                # pip compiles in the image; where it is told not to, each command here would compile all it imports
                if self.environment.get("PIP_COMPILE") == "0":
                    self.environment.pop("PYTHONDONTWRITEBYTECODE", None)

    def copy(self, source: Path, target: Path) -> None:
        if source.is_dir():
            shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, target / source.name)

    def run(self, text: str) -> None:
        """All but what needs root: the user and the owner of the volume."""
        for command in text.split(" && "):
            if command.startswith(("useradd ", "chown ")):
                continue
            words = shlex.split(self.here(command))
            words[0] = sys.executable if words[0] == "python" else words[0]
            subprocess.run(words, cwd=self.directory, env=self.environment, check=True, timeout=900)

    def start(self, *words: str, **environment: str) -> subprocess.Popen[bytes]:
        program = shutil.which(words[0], path=self.environment["PATH"])
        assert program is not None
        return subprocess.Popen([program, *words[1:]], cwd=self.directory, env={**self.environment, **environment})


@pytest.mark.deep
def test_steps_of_the_image_give_a_healthy_service(tmp_path: Path) -> None:
    replay = Replay(tmp_path)
    for step in steps():
        replay.play(step)
    assert (tmp_path / "data").is_dir()
    assert replay.start("substructures", "key", "create", "--scope", "admin").wait(120) == 0
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    (command,), (health,) = given("CMD"), given("HEALTHCHECK")
    check = json.loads(health[health.index("[") :].replace(":8000/", f":{port}/"))
    with replay.start(*json.loads(command), SUBSTRUCTURES_PORT=str(port)) as server:
        try:
            for _ in range(120):
                if replay.start(*check).wait() == 0:
                    break
                time.sleep(0.5)
            else:
                pytest.fail("the service did not become healthy")
        finally:
            server.terminate()
    assert {path.name for path in tmp_path.iterdir()} == {"source", "opt", "data"}
    for name in ("scheduler", "worker"):
        assert replay.start(*SERVICES[name]["command"][:2], "--help").wait(60) == 0
