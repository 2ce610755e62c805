"""A sweep on two machines of one core each, against the same on one machine of two: two network namespaces joined by a cable, over TLS, coordinator
on the first; a Unix socket. By turns, in one run.

usage: two_machines_bench.py <bin folder> <sweep file> [rounds]      3
"""
import pathlib, re, statistics, subprocess, sys, tempfile, time

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "fault"))
import two_machines
from two_machines import at

BIN, SWEEP = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
ROUNDS = int(sys.argv[3]) if len(sys.argv) > 3 else 3
HERE, THERE = "10.77.32.1", "10.77.32.2"


def call(*command):
    return subprocess.run([str(c) for c in command], check=True, capture_output=True, text=True).stdout


def seconds(path, name, listen, files, machines):
    """From the submission to the end of the last worker; machines: commands before those that run on each."""
    first = machines[0]
    on_core = [["taskset", "-c", str(k)] for k in range(len(machines))]
    coordinator = subprocess.Popen([str(c) for c in (*first, BIN / "irsig-coordinator", "--db", path / name, "--listen", listen,
                                                     "--audit-share=0", *files("coordinator"))], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        address = "--coordinator=" + re.search(r"listening on (\S+)", coordinator.stdout.readline())[1]
        start = time.monotonic()
        call(*first, BIN / "irsig", "submit", SWEEP, address, *files("user"))
        workers = [subprocess.Popen([str(c) for c in (*machine, *core, BIN / "irsig-worker", address, "--exit-when-finished", f"--name=core-{k}",
                                                      *files("worker"))])
                   for k, (machine, core) in enumerate(zip(machines, on_core))]
        codes = [worker.wait() for worker in workers]
        took = time.monotonic() - start
        assert codes == [0] * len(codes), codes
        return took
    finally:
        coordinator.terminate()
        coordinator.communicate()


def main():
    if reason := two_machines.why_not():
        sys.exit(reason)
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder)
        call(BIN / "irsig", "ca", "init", path / "ca")
        for who, *what in (("coordinator", f"--host={HERE}"), ("user", "--role=submit"), ("worker", "--role=work")):
            call(BIN / "irsig", "ca", "issue", path / "ca", who, "--out", path / "ca", *what)

        def tls(who):
            return [f"--tls-cert={path}/ca/{who}.pem", f"--tls-key={path}/ca/{who}.key", f"--tls-ca={path}/ca/ca.pem"]

        with two_machines.machine(f"{path.name}-a") as a, two_machines.machine(f"{path.name}-b") as b, \
                two_machines.cable(a, HERE + "/24", b, THERE + "/24"):
            shares = []
            for k in range(ROUNDS):
                one = seconds(path, f"one{k}.sigdb", f"unix:{path}/farm{k}", lambda who: [], [[], []])
                two = seconds(path, f"two{k}.sigdb", f"{HERE}:0", tls, [at(a), at(b)])
                assert call(BIN / "irsig", "digest", path / f"one{k}.sigdb") == call(BIN / "irsig", "digest", path / f"two{k}.sigdb")
                shares.append(one / two)
                print(f"one machine of two cores {one:6.2f} s, two machines of one core {two:6.2f} s: throughput {one / two:.3f}", flush=True)
            print(f"median {statistics.median(shares):.3f}")


main()
