"""auvid-validate campaign: the same numbers wherever its runs are made, however often it stops."""
import json
import pathlib
import subprocess
import sys
import time

import numpy as np
import pytest

from auvid_validation import campaign
from auvid_validation.cli import main

WORLD = "1 N, 60 s"


def run(out, *arguments):
    with pytest.raises(SystemExit) as end:
        main(["campaign", "--worlds", WORLD, "--runs", "6", "--out", str(out), *arguments])
    assert not end.value.code
    return lines(out)


def lines(out):
    return sorted(pathlib.Path(out, "runs.jsonl").read_text().splitlines())


@pytest.fixture(scope="module")
def one_process(tmp_path_factory):
    out = tmp_path_factory.mktemp("one")
    return out, run(out, "--workers", "1")


def test_a_campaign_gives_tables_and_figures(one_process, capsys):
    out, made = one_process
    numbers = json.loads((out / "campaign.json").read_text())[WORLD]
    errors = np.array([json.loads(line)["error"] for line in made])
    assert numbers["runs"] == 6
    assert np.isclose(numbers["rms_percent"][0], 100 * np.sqrt(np.mean(errors ** 2)))
    assert numbers["rms_percent"][1] < numbers["rms_percent"][0] < numbers["rms_percent"][2]
    assert 0.5 < numbers["efficiency"][0] < 2.5
    assert {path.name for path in out.glob("*.png")} == {"accuracy.png", "coverage.png"}


def test_existing_runs_are_not_repeated_and_a_truncated_line_is(one_process, tmp_path, monkeypatch):
    _, made = one_process
    kept = "\n".join(made[:4]) + "\n" + made[4][:100]
    (tmp_path / "runs.jsonl").write_text(kept)
    asked = []
    one = campaign.one
    monkeypatch.setattr(campaign, "one", lambda world: asked.append(world) or one(world))
    assert run(tmp_path, "--workers", "1") == made
    assert len(asked) == 2


def test_two_workers_of_which_one_is_killed_give_the_numbers_of_one_process(one_process, tmp_path):
    where, started = tmp_path / "scheduler.json", []

    def start(*arguments):
        started.append(subprocess.Popen([sys.executable, "-m", *arguments],
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))
        return started[-1]

    try:
        start("distributed.cli.dask_scheduler", "--port", "0", "--host", "127.0.0.1",
              "--no-dashboard", "--scheduler-file", str(where))
        workers = [start("distributed.cli.dask_worker", "--no-nanny", "--nthreads", "1",
                         "--no-dashboard", "--scheduler-file", str(where)) for _ in range(2)]
        until(where.exists)
        address = json.loads(where.read_text())["address"]
        import distributed
        with distributed.Client(address) as client:
            client.wait_for_workers(2, timeout=300)
        out = tmp_path / "out"
        job = start("auvid_validation", "campaign", "--worlds", WORLD, "--runs", "6",
                    "--out", str(out), "--scheduler", address)
        until(lambda: (out / "runs.jsonl").exists() and lines(out))
        workers[0].kill()
        assert len(lines(out)) < 6
        assert job.wait(600) == 0
    finally:
        for process in started:
            process.kill()
            process.wait()
    assert lines(out) == one_process[1]
    assert (out / "campaign.json").read_bytes() == (one_process[0] / "campaign.json").read_bytes()


def until(there):
    end = time.monotonic() + 300
    while not there():
        assert time.monotonic() < end
        time.sleep(0.02)


@pytest.mark.parametrize("arguments", [
    ("--worlds", "nowhere"), ("--runs", "1"), ("--workers", "0"), ("--out", "/dev/null/there"),
])
def test_bad_input_is_one_line_and_exit_status_2(arguments, capsys):
    with pytest.raises(SystemExit) as end:
        main(["campaign", *arguments])
    assert end.value.code == 2 and capsys.readouterr().err.count("\n") == 1


def test_an_interval_of_a_proportion_is_wilsons():
    low, high = campaign.proportion(95, 100)[1:]
    assert abs(low - 0.8882) < 1e-3 and abs(high - 0.9785) < 1e-3  # Wilson 1927, as tables have it
