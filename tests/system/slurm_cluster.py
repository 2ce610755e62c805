"""A cluster of Slurm on this machine, for tests: a controller and nodes of their own, beside whatever else runs here."""
import getpass, os, pathlib, shutil, signal, socket, subprocess, time

DAEMONS = ("munged", "slurmctld", "slurmd")
CONFIGURATION = """
ClusterName=test
SlurmctldHost={machine}(127.0.0.1)
SlurmctldPort={port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.sock
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=1,sched_interval=2
SwitchType=switch/none
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool-%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd-%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd-%n.log
SlurmctldTimeout=30
SlurmdTimeout={timeout}
KillWait=5
ReturnToService=2
JobRequeue=1
SlurmdParameters=config_overrides
MailProg=/bin/true
NodeName=n[0-{last}] NodeHostname={machine} NodeAddr=127.0.0.1 Port=[{first_port}-{last_port}] CPUs=2 RealMemory=2000 State=UNKNOWN
PartitionName=main Nodes=n[0-{last}] Default=YES MaxTime=INFINITE State=UP
"""


def free_ports(count):
    """So many in a row that nobody listens at."""
    for first in range(20000, 60000, 37):
        sockets = []
        try:
            for port in range(first, first + count):
                sockets.append(socket.socket())
                sockets[-1].bind(("127.0.0.1", port))
            return first
        except OSError:
            continue
        finally:
            for s in sockets:
                s.close()
    raise AssertionError("no free ports")


class Cluster:
    def __init__(self, folder, nodes=2, timeout_s=30):
        self.folder, self.nodes = pathlib.Path(folder), nodes
        self.folder.mkdir(mode=0o711)
        for name in ("state", *(f"spool-n{i}" for i in range(nodes))):
            (self.folder / name).mkdir()
        key = self.folder / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o600)
        port = free_ports(1 + nodes)
        self.environment = {**os.environ, "SLURM_CONF": str(self.folder / "slurm.conf"), "PATH": os.environ["PATH"] + ":/usr/sbin:/sbin"}
        (self.folder / "cgroup.conf").write_text("CgroupPlugin=cgroup/v1\n")
        (self.folder / "slurm.conf").write_text(CONFIGURATION.format(
            machine=socket.gethostname().split(".")[0], port=port, user=getpass.getuser(), folder=self.folder, timeout=timeout_s, last=nodes - 1,
            first_port=port + 1, last_port=port + nodes))
        self.processes = {}
        self.start("munged", "munged", "--foreground", "--force", f"--socket={folder}/munge.sock", f"--key-file={key}", f"--pid-file={folder}/munged.pid",
                   f"--log-file={folder}/munged.log", f"--seed-file={folder}/munge.seed")
        self.until(lambda: (self.folder / "munge.sock").exists(), "munged")
        self.start("slurmctld", "slurmctld", "-D", "-c")
        for i in range(nodes):
            self.start_node(i)
        self.until(lambda: self.run("sinfo", "-h", "-N", "-t", "idle", "-o", "%N", check=False).count("n") == nodes, "the nodes")

    def start(self, name, *command):
        log = open(self.folder / f"{name}.out", "ab")
        self.processes[name] = subprocess.Popen(command, env=self.environment, stdout=log, stderr=log, start_new_session=True)
        log.close()

    def start_node(self, i):
        self.start(f"n{i}", "slurmd", "-D", "-N", f"n{i}")

    def kill_node(self, i):
        """As a machine that loses power: the daemon and all that it has started."""
        spool = str(self.folder / f"spool-n{i}")
        os.killpg(self.processes[f"n{i}"].pid, signal.SIGKILL)
        self.processes[f"n{i}"].wait()
        for process in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                environment = (process / "environ").read_bytes()
                if f"SLURMD_NODENAME=n{i}\0".encode() in environment and str(self.folder).encode() in environment:
                    os.kill(int(process.name), signal.SIGKILL)
            except (OSError, ProcessLookupError):
                continue
        return spool

    def run(self, *command, check=True):
        done = subprocess.run([str(c) for c in command], env=self.environment, capture_output=True, text=True, timeout=120)
        assert not check or done.returncode == 0, f"{command}: {done.stdout}{done.stderr}"
        return done.stdout

    def until(self, fact, what, patience_s=60):
        end = time.monotonic() + patience_s
        while not fact():
            dead = [name for name, p in self.processes.items() if p.poll() is not None]
            if dead or time.monotonic() > end:
                raise AssertionError(f"{what} did not come up; ended: {dead}\n" + "\n".join(
                    f"{log.name}: {log.read_text(errors='replace')[-1500:]}" for log in sorted(self.folder.glob("*.out")) + sorted(self.folder.glob("*.log"))))
            time.sleep(0.1)

    def stop(self):
        self.run("scancel", "--full", "--user", getpass.getuser(), check=False)
        for process in reversed(self.processes.values()):
            if process.poll() is None:
                process.terminate()
        for process in self.processes.values():
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def missing():
    """Programs that this machine lacks."""
    path = os.environ["PATH"] + ":/usr/sbin:/sbin"
    return [name for name in (*DAEMONS, "sbatch", "squeue") if shutil.which(name, path=path) is None]
