"""A cluster's address: who may answer there, who does not, and whom a client trusts."""

import http.server
import socketserver
import sys
import threading
from concurrent.futures import CancelledError, Future
from contextlib import contextmanager, nullcontext, suppress

import dask
import pytest
from dask_station import BLOCK, PULSE, jobs_of, refusal, scheduler, wait_for_workers, working
from distributed import Security
from distributed.comm import CommClosedError

from analytic import simulate
from studies.kit import dask_client
from studies.kit.cluster import Cluster
from studies.kit.dask_client import ClusterError, workers_of


@pytest.fixture(autouse=True)
def patience(monkeypatch):
    """Wait for whoever answers, however slow; a test of who does not has less."""
    monkeypatch.setattr(dask_client, "CONNECT_S", 600.0)
    monkeypatch.setattr(dask_client, "ANSWER_S", 600.0)


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "nowhere", "::::", "tcp://"])
def test_an_address_where_nobody_answers(address, tmp_path, capsys):
    assert "scheduler" in refusal(address, capsys, tmp_path)


class Silent(socketserver.BaseRequestHandler):
    """Accepts, and never answers."""

    said = b""

    def handle(self):
        with suppress(ConnectionError):
            self.request.sendall(self.said)
            while self.request.recv(1024):
                pass


class Shell(Silent):
    """Speaks first, as an SSH server does."""

    said = b"SSH-2.0-OpenSSH_9.6\r\n"


class Web(http.server.BaseHTTPRequestHandler):
    def do_GET(self):
        self.send_response(200)
        self.end_headers()

    def log_message(self, *_):
        pass


@contextmanager
def server(handler):
    with socketserver.ThreadingTCPServer(("127.0.0.1", 0), handler) as serving:
        serving.daemon_threads = True
        threading.Thread(target=serving.serve_forever, daemon=True).start()
        yield "127.0.0.1:{1}".format(*serving.server_address)
        serving.shutdown()


@pytest.mark.parametrize(
    ("handler", "limit_s", "reason"),
    [
        (Silent, 1.0, "no answer within 1 s"),
        (Web, 1.0, "no answer within 1 s"),
        (Shell, 600.0, "does not speak Dask's protocol"),
    ],
)
def test_a_server_that_is_no_scheduler(handler, limit_s, reason, monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(dask_client, "CONNECT_S", limit_s)
    with server(handler) as place:
        assert reason in refusal(f"tcp://{place}", capsys, tmp_path)
        assert "needs certificates" in refusal(f"tls://{place}", capsys, tmp_path)


def test_a_scheduler_that_falls_silent_while_a_client_registers(monkeypatch, tmp_path, capsys):
    async def answered(*_):
        pass

    monkeypatch.setattr(dask_client, "CONNECT_S", 1.0)
    monkeypatch.setattr(dask_client, "_knock", answered)
    with server(Silent) as place:
        assert "no answer within 1 s" in refusal(f"tcp://{place}", capsys, tmp_path)


def test_missing_dask_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ClusterError, match=r"rocking\[cluster\]"):
        Cluster("tcp://127.0.0.1:1", 1.0).check()


class Breaking:
    """A client, and its executor, whose answer to every question is an error."""

    def __init__(self, status, error):
        self.status, self.error = status, error

    def nthreads(self):
        pass

    def sync(self, *_, **__):
        raise self.error

    def get_executor(self, **_):
        return self

    def submit(self, *_):
        future = Future()
        future.set_exception(self.error)
        return future


def answered(monkeypatch, status, error):
    """Return the answer to the one job that a client was given."""
    client = nullcontext(Breaking(status, error))
    monkeypatch.setattr("studies.kit.cluster.client_of", lambda _: client)
    ((_, response),) = Cluster("tcp://127.0.0.1:1", 1.0)(jobs_of("exact"))
    return response


BROKEN = [CommClosedError("in <TCP>: Stream is closed"), OSError("gone"), CancelledError()]


@pytest.mark.parametrize("error", BROKEN[:2])
def test_a_connection_that_breaks_at_a_question_is_a_scheduler_that_has_gone(error):
    with pytest.raises(ClusterError, match="scheduler has gone"):
        workers_of(Breaking("running", error), "tcp://127.0.0.1:1")


@pytest.mark.parametrize(
    ("status", "error"),
    [
        ("running", BROKEN[-1]),
        *((status, error) for status in ("connecting", "closed") for error in BROKEN),
    ],
)
def test_a_connection_that_breaks_before_the_answer_is_a_scheduler_that_has_gone(
    status, error, monkeypatch
):
    with pytest.raises(ClusterError, match="scheduler has gone"):
        answered(monkeypatch, status, error)


def test_an_error_of_a_job_is_a_row(monkeypatch):
    response = answered(monkeypatch, "running", OSError("no room"))
    assert response.outcome.value == "failed"
    assert "no room" in response.message


def certificates(folder):
    """Make a certificate that signs itself, and return the files of authority, it and its key."""
    made = Security.temporary()
    texts = (made.tls_ca_file, made.tls_client_cert, made.tls_client_key)
    folder.mkdir()
    files = [folder / name for name in ("ca.pem", "cert.pem", "key.pem")]
    for file, text in zip(files, texts, strict=True):
        file.write_text(text)
    return files


def configured(files):
    """Set what the environment variables that the messages name would set."""
    names = ("CA_FILE", "CLIENT__CERT", "CLIENT__KEY")
    variables = [f"DASK_DISTRIBUTED__COMM__TLS__{name}" for name in names]
    read = dask.config.collect_env(dict(zip(variables, map(str, files), strict=True)))
    return dask.config.set(dask.config.merge(dask.config.config, read))


def test_an_encrypted_cluster_answers_who_has_its_certificate(tmp_path, capsys):
    ours, others = certificates(tmp_path / "ours"), certificates(tmp_path / "others")
    options = [
        *("--tls-ca-file", ours[0], "--tls-cert", ours[1], "--tls-key", ours[2]),
        *("--protocol", "tls"),
    ]
    with scheduler(tmp_path, *options) as (address, _), working(address, "--no-nanny", *options):
        assert address.startswith("tls://")
        with configured(ours):
            wait_for_workers(address, 1)
            ((_, response),) = Cluster(address, 10.0)(jobs_of("exact"))
            plain = address.replace("tls:", "tcp:")
            with dask.config.set({"distributed.comm.require-encryption": True}):
                assert "encryption required" in refusal(plain, capsys, tmp_path)
        assert response.peak_ratio == simulate(BLOCK, PULSE).peak_ratio
        assert "DASK_DISTRIBUTED__COMM__TLS__CA_FILE" in refusal(address, capsys, tmp_path)
        with configured(others):
            assert "certificate does not match" in refusal(address, capsys, tmp_path)
        with configured([tmp_path / "missing.pem"] * 3):
            assert "No such file" in refusal(address, capsys, tmp_path)
