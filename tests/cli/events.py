"""Waiting for events, so that a test passes on a machine of any speed, however busy: for a condition, and for a process that is about to
work on a file."""

import contextlib
import os
import pathlib
import select
import signal
import time

from stand_in import StandIn

HANGS = 600  # seconds after which nothing is waited for any longer

# Loaded before glibc, with four lines of settings: a pipe, functions, part of a path, and a number. A process stops itself (SIGSTOP) before
# the call of that number of those functions that concern a file whose path contains that part, and writes "stopped" and its own number into
# the pipe before. At its end it writes "made" and how many such calls there were. Every process has the pipe open while it lives.
STOPPER = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))
static int pipe_end = -1, calls;
static char settings[4][4096];
__attribute__((constructor)) static void begin(void) {
  Dl_info here;
  char path[4096];
  dladdr(&pipe_end, &here);
  snprintf(path, sizeof path, "%.*s/settings", (int)(strrchr(here.dli_fname, '/') - here.dli_fname), here.dli_fname);
  FILE* file = fopen(path, "r");
  for (int i = 0; i < 4; ++i)
    if (fgets(settings[i], sizeof settings[i], file)) settings[i][strcspn(settings[i], "\n")] = 0;
  fclose(file);
  pipe_end = REAL(open)(settings[0], O_WRONLY | O_CLOEXEC);
}
static void tell(const char* what, int number) {
  char text[32];
  REAL(write)(pipe_end, text, (size_t)snprintf(text, sizeof text, "%s %d\n", what, number));
}
__attribute__((destructor)) static void end(void) { tell("made", calls); }
static void at(const char* call, const char* path) {
  if (pipe_end < 0 || !strstr(settings[1], call) || !strstr(path, settings[2])) return;
  if (__sync_add_and_fetch(&calls, 1) != atoi(settings[3])) return;
  tell("stopped", (int)getpid());
  raise(SIGSTOP);
}
static void at_file(const char* call, int file) {
  char link[32], path[4096];
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  const ssize_t size = readlink(link, path, sizeof path - 1);
  path[size < 0 ? 0 : size] = 0;
  at(call, path);
}
#define OPEN(name) \
  int name(const char* path, int flags, ...) { \
    va_list more; va_start(more, flags); const int mode = va_arg(more, int); va_end(more); \
    at("open", path); \
    return REAL(name)(path, flags, mode); \
  }
OPEN(open)
OPEN(open64)
ssize_t write(int file, const void* bytes, size_t size) { at_file("write", file); return REAL(write)(file, bytes, size); }
int fsync(int file) { at_file("fsync", file); return REAL(fsync)(file); }
int rename(const char* from, const char* to) { at("rename", to); return REAL(rename)(from, to); }
int unlink(const char* path) { at("unlink", path); return REAL(unlink)(path); }
"""


def wait_until(ready, what, seconds=HANGS):
    """What `ready` returns, once that is something. For what no pipe, socket or child reports."""
    end = time.monotonic() + seconds
    while not (found := ready()):
        if time.monotonic() > end:
            raise AssertionError(f"{what}: not after {seconds} seconds")
        time.sleep(0.01)
    return found


def wait_until_newer_than(file):
    """Returns once a file that is written next is newer than this one, for tools that compare times. The clock of a file system stands
    still for some milliseconds."""
    probe = file.with_name(file.name + ".newer")

    def is_newer():
        probe.touch()
        return probe.stat().st_mtime_ns > file.stat().st_mtime_ns

    wait_until(is_newer, f"a file that is newer than {file}")
    probe.unlink()


def status(process):
    """The lines of /proc/PROCESS/status as a dictionary; empty if there is no such process."""
    try:
        lines = pathlib.Path(f"/proc/{process}/status").read_text(encoding="utf-8").splitlines()
    except OSError:
        return {}
    return dict(line.split(":\t", 1) for line in lines if ":\t" in line)


def is_stopped(process):
    return status(process).get("State", "").startswith("T")


def is_alive(process):
    """A process that has ended, and that nobody has asked about yet, is not alive."""
    return status(process).get("State", "Z")[0] not in "ZX"


def awaits(process, number):
    """Whether a signal was sent to a process that has not taken it yet, as while it is stopped."""
    return int(status(process).get("ShdPnd", "0"), 16) >> (number - 1) & 1 == 1


def worked(process):
    """The processor seconds of a process."""
    fields = pathlib.Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rsplit(")", 1)[1].split()
    return sum(map(int, fields[11:13])) / os.sysconf("SC_CLK_TCK")


class Stopper:
    """Stops processes before they do something to a file, so that a test can look, or kill them, at that point."""

    def __init__(self, binary, folder):
        # the most of one process
        self.library, self.pipe, self.calls = StandIn(binary, pathlib.Path(folder) / "stand_in",
                                                      STOPPER), pathlib.Path(folder) / "stopped", 0
        os.mkfifo(self.pipe)

    def environment(self, calls, part, count=1):
        """Of a process that is to stop before call number `count` of the named functions, such as "write fsync", to a file whose path
        contains `part`."""
        return self.library.environment(f"{self.pipe}\n{calls}\n{part}\n{count}\n")

    @contextlib.contextmanager
    def listening(self, seconds=HANGS):
        """Start the process inside, and call what this gives: it waits until a process has stopped and returns its number, or None when
        all have ended."""
        self.calls = 0
        end, waiting = os.open(self.pipe, os.O_RDONLY | os.O_NONBLOCK), select.poll()
        lines: list[str] = []
        waiting.register(end, select.POLLIN)

        def stopped():
            while True:
                if not lines:
                    if not waiting.poll(1000 * seconds):
                        raise AssertionError(f"no process stopped or ended in {seconds} seconds")
                    lines.extend(os.read(end, 4096).decode().splitlines())
                if not lines:
                    return None
                what, number = lines.pop(0).split()
                if what == "stopped":
                    wait_until(lambda: is_stopped(number), f"process {number} stops")
                    return int(number)
                self.calls = max(self.calls, int(number))

        try:
            yield stopped
        finally:
            os.close(end)


def go_on(process):
    os.kill(process, signal.SIGCONT)
