"""Two network namespaces as two machines, and a link between them that loses, delays, doubles and reorders packets, or is cut.

As a program it is the link (BadLink starts it):  two_machines.py NAMESPACE ADDRESS NAMESPACE ADDRESS
Each line of its standard input is how the link is from then on, [to the second, to the first] of LINK's fields as JSON; what it did with the
packets so far is its answer.
"""
import contextlib, ctypes, fcntl, heapq, json, os, random, selectors, shutil, struct, subprocess, sys, time

LINK = {"loss": 0.0, "doubled": 0.0, "delay_s": 0.0, "jitter_s": 0.0}  # of packets; jitter: evenly, so that they overtake each other
TUN = "/dev/net/tun"


def why_not():
    """Why this machine cannot be two; empty if it can."""
    if os.geteuid() != 0:
        return "only root makes network namespaces"
    if not shutil.which("ip"):
        return "there is no program ip (package iproute2)"
    if not os.path.exists(TUN):
        return f"there is no {TUN}"
    name = f"irsig-{os.getpid()}-try"
    tried = subprocess.run(["ip", "netns", "add", name], capture_output=True, text=True)
    if tried.returncode == 0:
        subprocess.run(["ip", "netns", "delete", name], check=True)
    return tried.stderr.strip()


@contextlib.contextmanager
def machine(name):
    """A network namespace of that name with a loopback interface."""
    subprocess.run(["ip", "netns", "add", name], check=True)
    try:
        subprocess.run(["ip", "-n", name, "link", "set", "lo", "up"], check=True)
        yield name
    finally:
        subprocess.run(["ip", "netns", "delete", name], check=True)


def at(name, *command):
    """A command as it is run on that machine."""
    return ["ip", "netns", "exec", name, *map(str, command)]


@contextlib.contextmanager
def cable(a, address_a, b, address_b):
    """A link without faults. Addresses with their prefix: 10.0.0.1/24"""
    subprocess.run(["ip", "link", "add", "cable", "netns", a, "type", "veth", "peer", "name", "cable", "netns", b], check=True)
    for name, address in ((a, address_a), (b, address_b)):
        subprocess.run(["ip", "-n", name, "address", "add", address, "dev", "cable"], check=True)
        subprocess.run(["ip", "-n", name, "link", "set", "cable", "up"], check=True)
    yield


class BadLink:
    """A link with faults, while it is entered."""

    def __init__(self, a, address_a, b, address_b):
        self.command = [sys.executable, __file__, a, address_a, b, address_b]

    def __enter__(self):
        self.process = subprocess.Popen(self.command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.becomes()
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.communicate()

    def becomes(self, to_b={}, to_a=None):
        """How it is from now on, {field of LINK: value}, both ways alike unless both are said; what it did so far, by kind of fault."""
        ways = [LINK | to_b, LINK | (to_b if to_a is None else to_a)]
        assert all(way.keys() == LINK.keys() for way in ways)
        self.process.stdin.write(json.dumps(ways) + "\n")
        self.process.stdin.flush()
        return json.loads(self.process.stdout.readline())


def open_tun(namespace, address):
    libc = ctypes.CDLL(None, use_errno=True)

    def enter(path):
        with open(path) as place:
            if libc.setns(place.fileno(), 0x40000000) != 0:  # CLONE_NEWNET
                raise OSError(ctypes.get_errno(), f"setns {path}")

    enter(f"/run/netns/{namespace}")
    device = os.open(TUN, os.O_RDWR | os.O_NONBLOCK)
    fcntl.ioctl(device, 0x400454CA, struct.pack("16sH22x", b"bad", 0x0001 | 0x1000))  # TUNSETIFF: IFF_TUN | IFF_NO_PI
    enter(f"/proc/{os.getppid()}/ns/net")
    subprocess.run(["ip", "-n", namespace, "address", "add", address, "dev", "bad"], check=True)
    subprocess.run(["ip", "-n", namespace, "link", "set", "bad", "up"], check=True)
    return device


def carry(ends):
    random.seed(1)
    done = {"carried": 0, "lost": 0, "doubled": 0}
    ways = [LINK, LINK]
    under_way, number = [], 0  # (when it arrives, number, where, packet)
    choose = selectors.DefaultSelector()
    choose.register(sys.stdin, selectors.EVENT_READ)
    for end in ends:
        choose.register(end, selectors.EVENT_READ)
    while True:
        wait_s = max(0.0, under_way[0][0] - time.monotonic()) if under_way else None
        for key, _ in choose.select(wait_s):
            if key.fileobj is sys.stdin:
                line = sys.stdin.readline()
                if not line:
                    return
                ways = json.loads(line)
                print(json.dumps(done), flush=True)
                continue
            to = 1 - ends.index(key.fileobj)
            way = ways[1 - to]
            with contextlib.suppress(BlockingIOError):
                while True:
                    packet = os.read(key.fileobj, 1 << 16)
                    if random.random() < way["loss"]:
                        done["lost"] += 1
                        continue
                    twice = random.random() < way["doubled"]
                    done["carried"] += 1
                    done["doubled"] += twice
                    for _ in range(1 + twice):
                        number += 1
                        arrives = time.monotonic() + way["delay_s"] + random.random() * way["jitter_s"]
                        heapq.heappush(under_way, (arrives, number, ends[to], packet))
        while under_way and under_way[0][0] <= time.monotonic():
            _, _, end, packet = heapq.heappop(under_way)
            with contextlib.suppress(BlockingIOError):  # as if lost: the other side's queue is full
                os.write(end, packet)


if __name__ == "__main__":
    carry([open_tun(*sys.argv[1:3]), open_tun(*sys.argv[3:5])])
