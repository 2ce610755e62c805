"""A small disk that can be full, or turn read-only while files on it are open for writing, in a mount namespace of this process.

What a machine does not allow is said by why_not(), and by a disk's `kind`: "ext4" (an image on a loop device: root), "tmpfs" (never read-only),
"folder" (neither).
"""
import ctypes, errno, os, pathlib, subprocess

CLONE_NEWNS, CLONE_NEWUSER = 0x00020000, 0x10000000


def enter_namespace():
    """From here on, what this process and its children mount is theirs and goes with them. False: this machine does not allow it."""
    libc = ctypes.CDLL(None, use_errno=True)
    user, group = os.geteuid(), os.getegid()
    if libc.unshare(CLONE_NEWNS) != 0:
        if user == 0 or libc.unshare(CLONE_NEWNS | CLONE_NEWUSER) != 0:
            return False
        for name, text in (("setgroups", "deny"), ("uid_map", f"0 {user} 1"), ("gid_map", f"0 {group} 1")):
            pathlib.Path(f"/proc/self/{name}").write_text(text)
    return run("mount", "--make-rprivate", "/") == ""


def run(*command):
    """Empty if it succeeded, else what it said."""
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    return "" if done.returncode == 0 else done.stderr.strip() or f"{command[0]}: exit code {done.returncode}"


class SmallDisk:
    """To be made after enter_namespace() was true; `path` is its folder."""

    def __init__(self, path, megabytes, kinds=("ext4", "tmpfs")):
        self.path, self.image = pathlib.Path(path), pathlib.Path(f"{path}.ext4")
        self.path.mkdir()
        self.why = {}
        for kind in kinds:
            self.why[kind] = self._make_ext4(megabytes) if kind == "ext4" else run("mount", "-t", "tmpfs", "-o", f"size={megabytes}m", "tmpfs", self.path)
            if not self.why[kind]:
                self.kind = kind
                return
        self.kind = "folder"

    def _make_ext4(self, megabytes):
        with open(self.image, "wb") as image:
            image.truncate(megabytes << 20)
        try:
            return run("mkfs.ext4", "-q", self.image) or self.mount()
        except FileNotFoundError as missing:
            return str(missing)

    def mount(self):
        return run("mount", "-o", "loop,noatime", self.image, self.path)

    def close(self):
        if self.kind != "folder":
            run("umount", "--lazy", self.path)

    def fill(self):
        """Not a byte is free."""
        with open(self.path / "ballast", "wb", buffering=0) as ballast:
            size = os.fstatvfs(ballast.fileno()).f_bfree * os.fstatvfs(ballast.fileno()).f_frsize
            while size > 0:
                try:
                    os.posix_fallocate(ballast.fileno(), os.fstat(ballast.fileno()).st_size, size)
                except OSError as error:
                    if error.errno != errno.ENOSPC:
                        raise
                    size //= 2
            os.fsync(ballast.fileno())

    def empty(self):
        (self.path / "ballast").unlink()

    def becomes_read_only(self):
        """Of ext4: whoever has a file open meets it with the next write."""
        return run("mount", "-o", "remount,abort", self.path)

    def becomes_writable(self):
        """Refused while somebody has a file open there. What was synced is there."""
        return run("umount", self.path) or run("e2fsck", "-p", self.image) and run("e2fsck", "-fy", self.image) or self.mount()
