// The system calls of the program as functions of Node. Arguments are those of Linux on a machine of 32 bits; a result below 0 is an errno.
import * as fs from 'node:fs';
import * as os from 'node:os';
import { basename, dirname, join } from 'node:path';
import { isatty } from 'node:tty';
import { MessageChannel, receiveMessageOnPort } from 'node:worker_threads';

const windows = process.platform === 'win32';
const PAGE = 65536, MOST = 2 ** 32 - PAGE;  // bytes of memory
const MOST_THREADS = 16;                    // each has a stack and an engine of its own
const BROKEN_PIPE = 141;                    // the exit code
const FIRST_FOLDER = 1 << 20;               // folders that are open have numbers from here
const FIRST_VIRTUAL = 1 << 24;              // and so have pipes and memory
const BYTES = 0, ENDED = 1, CRASHED = 2, PIPED = 3;  // kinds of messages

// Flags of open(2) in musl, and what Node calls them.
const O_DIRECTORY = 0o200000, O_APPEND = 0o2000;
const OPEN_FLAGS = [[1, 'O_WRONLY'], [2, 'O_RDWR'], [0o100, 'O_CREAT'], [0o200, 'O_EXCL'], [0o400, 'O_NOCTTY'], [0o1000, 'O_TRUNC'],
  [O_APPEND, 'O_APPEND'], [0o4000, 'O_NONBLOCK'], [0o400000, 'O_NOFOLLOW']];
const AT_FDCWD = -100, AT_REMOVEDIR = 0x200, AT_SYMLINK_NOFOLLOW = 0x100, AT_EMPTY_PATH = 0x1000;
const TIOCGWINSZ = 0x5413;
const KINDS = [['isFile', 8], ['isDirectory', 4], ['isSymbolicLink', 10], ['isFIFO', 1], ['isCharacterDevice', 2], ['isBlockDevice', 6],
  ['isSocket', 12]];
const EINVAL = 'EINVAL', sleeper = new Int32Array(new SharedArrayBuffer(4));

// The signal by which Linux ends a process for what WebAssembly throws.
const SIGNALS = [[/^it was ended/, 9], [/unreachable/, 4], [/^Aborted/, 6], [/divide|integer overflow/, 8]];
const signalOf = crash => SIGNALS.find(([what]) => what.test(crash))?.[1] ?? 11;

class CallError extends Error {
  constructor(code) {
    super(code);
    this.code = code;
  }
}

export class Host {
  /** @type {() => Record<string, number>} */ errno = () => ({});
  /** @type {() => Uint8Array} */ bytes = () => new Uint8Array();
  #files = new Map();      // of descriptors: { at, path, lock }; `at` is the place where is read and written, null of what has no places
  #folders = new Map();    // open ones: { path, entries, next }
  #virtual = new Map();    // descriptors without a file: { memory, at }, { pipe } to read, { to } a pipe to write, {} the null device
  #free = FIRST_VIRTUAL;
  #processes = new Map();  // by number: { port, bell, state, end }; 0 is the one that started this one
  #inbox = [];             // messages for cloudbake_receive: { from, kind, bytes }
  #pipes = [];             // { chunks, writers }, the numbers of processes that may write
  #message = { kind: 0, bytes: new Uint8Array() };
  #seenSignal = 0;

  /**
   * What a process is given: its command line, ports to the launcher and to the process that started it, which counts in `parentBell` what
   * is sent to it, and the descriptors that it inherits. `signals` has the number of one that was noted, and whether any is; `limit`, which
   * its threads share, the most bytes of memory, or 0.
   * @param {{ words: string[], columns: number, program: string, signals: Int32Array, bell: Int32Array, limit: Float64Array,
   *   launcher: MessagePort, parentBell?: Int32Array, parent?: MessagePort, is_helper?: boolean, inherited?: [number, any][] }} given
   */
  constructor({ words, columns, program, signals, bell, limit, launcher, parentBell, parent, is_helper = false, inherited = [] }) {
    Object.assign(this, { words, columns, program, signals, bell, limit, launcher, isHelper: is_helper });
    if (parent) this.#processes.set(0, { port: parent, bell: parentBell });
    for (const [number, what] of inherited) this.#virtual.set(number, what);
    for (const [name, call] of Object.entries(calls))
      this[name] = (...given) => {
        try {
          return call.apply(this, given) ?? 0;
        } catch (error) {
          const number = this.errno()[error.code];
          if (number === undefined) throw error;
          return /^(fd|cloudbake)_/.test(name) ? number : -number;
        }
      };
  }

  // Emscripten writes a byte for each character.
  environment() {
    return Object.fromEntries(Object.entries(process.env).map(([name, value]) => [name, Buffer.from(value).toString('latin1')]));
  }

  grownMemory(wanted, now) {
    if (wanted > this.memoryLimit) return 0;
    const more = Math.min(now * 1.2, now + 96 * 2 ** 20);
    return Math.floor(Math.min(this.memoryLimit, Math.max(wanted + PAGE - 1, more)) / PAGE) * PAGE;
  }

  get memoryLimit() { return this.limit[0] || MOST; }
  cloudbake_limit_memory(bytes) { this.limit[0] = Math.min(MOST, Math.ceil(bytes / PAGE) * PAGE); }
  cloudbake_memory_limit() { return this.memoryLimit; }
  cloudbake_machine_memory() {
    const allowed = process.constrainedMemory?.() ?? 0;
    return allowed > 0 ? Math.min(allowed, os.totalmem()) : os.totalmem();
  }
  cloudbake_processors() { return os.availableParallelism?.() ?? os.cpus().length; }

  threadCount() { return Math.min(MOST_THREADS, this.cloudbake_processors()); }
  /** Has a thread of this copy started. @param {{ thread: number, routine: number, argument: number, memory: WebAssembly.Memory }} what */
  startThread(what) {
    this.launcher.postMessage({ thread: what });
    return 0;
  }

  // --- Signals, locks, temporary files ---

  cloudbake_process_number() { return process.pid; }
  cloudbake_is_running(number) {
    try {
      process.kill(number, 0);
    } catch (error) {
      return Number(error.code === 'EPERM');
    }
    return 1;
  }
  cloudbake_machine_name(at, size) {
    const name = Buffer.from(os.hostname()).subarray(0, size - 1);
    this.bytesAt(at, size).fill(0).set(name);
  }
  cloudbake_temporary(path, exists) { this.launcher.postMessage({ temporary: this.textAt(path), exists: exists !== 0 }); }
  cloudbake_note_signals() { Atomics.store(this.signals, 1, 1); }
  cloudbake_noted_signal() { return Atomics.load(this.signals, 0); }

  // --- Processes ---

  start(words, is_helper, inherited) {
    const { port1, port2 } = new MessageChannel();
    // The state becomes 1 when the thread has ended.
    const [bell, state] = [0, 0].map(() => new Int32Array(new SharedArrayBuffer(4))), number = this.#processes.size + 1;
    this.#processes.set(number, { port: port1, bell, state, is_helper });
    const given = { words, number, is_helper, parent: port2, bell, parentBell: this.bell, state, inherited };
    this.launcher.postMessage({ start: given }, [port2]);
    return number;
  }
  // A copy of what a descriptor is here, for another process: an end of a pipe to write, or memory from its start.
  forChild(source) {
    const what = this.#virtual.get(source);
    return what?.memory ? { memory: what.memory, at: 0 } : what?.writes === undefined ? {} : { to: what.writes };
  }
  cloudbake_start(words, word_count, pairs, count) {
    const list = [], bytes = this.bytes(), inherited = new Map();
    for (let at = words >>> 0; list.length < word_count;) {
      const end = bytes.indexOf(0, at);
      list.push(Buffer.from(bytes.slice(at, end)).toString());
      at = end + 1;
    }
    if (this.#virtual.has(0)) inherited.set(0, this.forChild(0));
    const view = this.view(), writes = [];
    for (let i = 0; i < count; ++i) {
      const [number, source] = [0, 4].map(offset => view.getInt32((pairs >>> 0) + 8 * i + offset, true));
      const what = this.forChild(source);
      inherited.set(number, what);
      if (what.to !== undefined) writes.push(this.#pipes[what.to]);
    }
    const process_number = this.start(list, false, [...inherited]);
    for (const { writers } of writes) writers.add(process_number);
    return process_number;
  }
  // It reads what this copy was given: standard input, and the orders of a worker.
  cloudbake_start_helper() {
    const given = [...this.#virtual.keys()].filter(number => this.#virtual.get(number).memory);
    return this.start(this.words, true, given.map(number => [number, this.forChild(number)]));
  }
  cloudbake_is_helper() { return Number(this.isHelper); }
  cloudbake_stop(number) { this.launcher.postMessage({ stop: number }); }
  cloudbake_wait(number, signal) {
    const one = this.#processes.get(number);
    while (!one.end) this.listen();
    this.view().setInt32(signal >>> 0, one.end.crash === undefined ? 0 : signalOf(one.end.crash), true);
    return one.end.code ?? 0;
  }
  cloudbake_send(number, at, size) { this.post(number, { kind: BYTES, bytes: this.bytes().slice(at >>> 0, (at >>> 0) + size) }); }
  cloudbake_receive() {
    while (this.#inbox.length === 0) {
      const rung = Atomics.load(this.bell, 0), signal = Atomics.load(this.signals, 0);
      if (signal !== this.#seenSignal) {
        this.#seenSignal = signal;
        return -1;
      }
      this.listen(Infinity, rung);
    }
    this.#message = this.#inbox.shift();
    return this.#message.from;
  }
  cloudbake_message_kind() { return this.#message.kind; }
  cloudbake_message_size() { return this.#message.bytes.length; }
  cloudbake_take_message(at) { this.bytesAt(at, this.#message.bytes.length).set(this.#message.bytes); }

  cloudbake_pipe(at) {
    const pipe = { chunks: [], writers: new Set() }, id = this.#pipes.push(pipe) - 1, ends = [this.#free++, this.#free++];
    this.#virtual.set(ends[0], { pipe });
    this.#virtual.set(ends[1], { writes: id });
    ends.forEach((end, i) => this.view().setInt32((at >>> 0) + 4 * i, end, true));
  }
  cloudbake_memory_file(at, size) {
    const number = this.#free++;
    this.#virtual.set(number, { memory: this.bytes().slice(at >>> 0, (at >>> 0) + size), at: 0 });
    return number;
  }
  cloudbake_wait_for_bytes(descriptor, milliseconds) {
    const { pipe } = this.#virtual.get(descriptor), end = performance.now() + milliseconds;
    while (pipe.chunks.length === 0 && pipe.writers.size > 0) {
      const left = end - performance.now();
      if (left <= 0) return 0;
      this.listen(left);
    }
    return 1;
  }

  post(number, message) {
    const to = this.#processes.get(number);
    if (!to) return;
    to.port.postMessage(message);
    Atomics.add(to.bell, 0, 1);
    Atomics.notify(to.bell, 0);
  }
  /** Tells whoever waits for this process how it has ended: { code } or { crash }. */
  tellEnd(ended) {
    this.post(0, ended.crash === undefined ? { kind: ENDED, bytes: Buffer.from(String(ended.code)) }
      : { kind: CRASHED, bytes: Buffer.from(ended.crash) });
    this.launcher.postMessage({ ended });
  }
  // Takes the messages that are there, or waits until the bell rings after its count `rung`: for the next one, or for a signal.
  listen(milliseconds = Infinity, rung = Atomics.load(this.bell, 0)) {
    let took = false;
    for (const [number, one] of this.#processes) {
      if (one.end) continue;
      const has_ended = one.state && Atomics.load(one.state, 0) === 1;
      for (let received; (received = receiveMessageOnPort(one.port)); took = true) this.take(number, one, received.message);
      if (has_ended && !one.end) this.take(number, one, { kind: CRASHED, bytes: Buffer.from('it was ended') }), took = true;
    }
    if (!took) Atomics.wait(this.bell, 0, rung, milliseconds);
  }
  take(from, one, { kind, bytes, pipe }) {
    if (kind === PIPED) return void this.#pipes[pipe].chunks.push(bytes);
    if (kind !== BYTES) {
      const text = Buffer.from(bytes).toString();
      one.end = kind === ENDED ? { code: Number(text) } : { crash: text };
      for (const { writers } of this.#pipes) writers.delete(from);
    }
    if (kind === BYTES || one.is_helper) this.#inbox.push({ from, kind, bytes });
  }

  readVirtual(what, buffer) {
    if (what.memory) {
      const part = what.memory.subarray(what.at, what.at + buffer.length);
      buffer.set(part);
      what.at += part.length;
      return part.length;
    }
    if (!what.pipe) return 0;
    const { chunks, writers } = what.pipe;
    while (chunks.length === 0 && writers.size > 0) this.listen();
    if (chunks.length === 0) return 0;
    const [first] = chunks, part = first.subarray(0, buffer.length);
    buffer.set(part);
    if (part.length < first.length) chunks[0] = first.subarray(part.length);
    else chunks.shift();
    return part.length;
  }
  writeVirtual(what, buffer) {
    if (what.to !== undefined) this.post(0, { kind: PIPED, pipe: what.to, bytes: buffer.slice() });
    return buffer.length;
  }

  // --- Arguments ---

  view() { return new DataView(this.bytes().buffer); }
  bytesAt(at, count) { return this.bytes().subarray(at >>> 0, (at >>> 0) + count); }
  textAt(at) {
    const bytes = this.bytes(), begin = at >>> 0;
    return Buffer.from(bytes.slice(begin, bytes.indexOf(0, begin)));
  }
  // A path, as bytes: names need not be text. On Windows a path from a drive is /C:/… for the program.
  pathAt(at, folder = AT_FDCWD) {
    let path = at ? this.textAt(at) : Buffer.alloc(0);
    if (path.length === 0) throw new CallError('ENOENT');
    if (path.equals(Buffer.from('/proc/self/exe'))) path = Buffer.from(this.program);
    if (folder !== AT_FDCWD && path[0] !== 47) {
      const open = this.#folders.get(folder);
      if (!open) throw new CallError('ENOTDIR');
      path = Buffer.concat([open.path, Buffer.from('/'), path]);
    }
    return windows ? path.toString().replace(/^\/([A-Za-z]:)/, '$1') : path;
  }
  // The third or fourth argument of a function with "...".
  argument(at) { return at ? this.view().getInt32(at >>> 0, true) : 0; }

  writeStat(at, stat) {
    const view = this.view(), place = at >>> 0;
    const put = (offset, value) => view.setUint32(place + offset, Number(BigInt.asUintN(32, value)), true);
    for (const [offset, value] of [[0, stat.dev], [4, 0n], [8, stat.ino], [12, stat.mode], [16, stat.nlink], [20, stat.uid], [24, stat.gid],
      [28, stat.rdev], [32, 0n], [48, stat.blksize ?? 4096n], [52, stat.blocks ?? 0n]]) put(offset, value);
    view.setBigInt64(place + 40, stat.size, true);
    for (const [offset, time] of [[56, stat.atimeNs], [64, stat.mtimeNs], [72, stat.ctimeNs]]) {
      put(offset, time / 1000000000n);
      put(offset + 4, time % 1000000000n);
    }
    view.setBigUint64(place + 80, BigInt.asUintN(64, stat.ino), true);
  }

  // --- Descriptors ---

  // Where is read or written; null leaves it to the system.
  placeOf(descriptor) {
    if (this.#folders.has(descriptor)) throw new CallError('EISDIR');
    if (descriptor > 2 && !this.#files.has(descriptor)) throw new CallError('EBADF');  // it may be one of Node's own
    return this.#files.get(descriptor)?.at ?? null;
  }
  move(descriptor, count) {
    const file = this.#files.get(descriptor);
    if (file && file.at !== null) file.at += count;
  }
  open(path, flags, mode) {
    let given = 0;
    for (const [flag, name] of OPEN_FLAGS) if (flags & flag) given |= fs.constants[name] ?? 0;
    if (flags & O_DIRECTORY) {
      if (!fs.statSync(path).isDirectory()) throw new CallError('ENOTDIR');
      const number = FIRST_FOLDER + (this.folderCount = (this.folderCount ?? 0) + 1);
      this.#folders.set(number, { path: Buffer.from(path), entries: null, next: 0 });
      return number;
    }
    const number = fs.openSync(path, given, mode);
    const stat = fs.fstatSync(number);
    this.#files.set(number, { at: stat.isFile() && !(flags & O_APPEND) ? 0 : null, path: Buffer.from(path) });
    return number;
  }
  forBuffers(list, count, transfer) {
    let all = 0;
    for (let i = 0; i < count; ++i) {
      const view = this.view(), at = (list >>> 0) + 8 * i, size = Math.min(view.getUint32(at + 4, true), 2 ** 30);
      if (size === 0) continue;
      const done = transfer(this.bytesAt(view.getUint32(at, true), size));
      all += done;
      if (done < size) break;
    }
    return all;
  }
  // Node makes no difference between what blocks and what does not; a pipe of another program may be full or empty for now.
  waiting(action) {
    for (;;) {
      try {
        return action();
      } catch (error) {
        if (error.code === 'EOF') return 0;  // on Windows
        if (error.code === 'EPIPE') this.endByPipe();
        if (error.code !== 'EAGAIN') throw error;
        Atomics.wait(sleeper, 0, 0, 2);
      }
    }
  }

  // As by SIGPIPE: without a word, at once.
  endByPipe() {
    this.tellEnd({ code: BROKEN_PIPE });
    Atomics.wait(sleeper, 0, 0);
  }

  virtual(descriptor) { return this.#virtual.get(descriptor); }
  copyVirtual(from, to) { this.#virtual.set(to, { ...this.#virtual.get(from) }); }
  folder(descriptor) { return this.#folders.get(descriptor); }
  unlock(descriptor) {
    const lock = this.#files.get(descriptor)?.lock;
    if (lock) fs.rmSync(lock, { force: true });
  }
  /** Whether there is no file of the system behind it. */
  forget(descriptor) {
    this.#files.delete(descriptor);
    return this.#folders.delete(descriptor) || this.#virtual.delete(descriptor);
  }
  fileAt(descriptor) { return this.#files.get(descriptor); }
}

// Functions whose errors become errnos. `this` is the host.
const calls = {
  // A lock is a file beside the one that is locked, which has the machine and the number of the process in its name.
  cloudbake_lock(descriptor, alone) {
    const { path } = this.fileAt(descriptor), name = path.toString(), machine = os.hostname().replace(/[^\w-]/g, '_');
    const lock = `${name}.${machine}.${process.pid}.${alone ? 'alone' : 'shared'}`;
    fs.closeSync(fs.openSync(lock, 'w'));
    this.fileAt(descriptor).lock = lock;
    for (const other of fs.readdirSync(dirname(name))) {
      const [, of_machine, number, kind] = other.match(/\.([\w-]+)\.(\d+)\.(alone|shared)$/) ?? [];
      if (!other.startsWith(`${basename(name)}.`) || !kind || (of_machine === machine && Number(number) === process.pid)) continue;
      if (of_machine === machine && !this.cloudbake_is_running(Number(number))) {
        fs.rmSync(join(dirname(name), other), { force: true });
      } else if (alone || kind === 'alone') {
        this.unlock(descriptor);
        throw new CallError('EAGAIN');
      }
    }
  },
  cloudbake_usage(seconds, kilobytes) {
    const { userCPUTime, systemCPUTime, maxRSS } = process.resourceUsage();
    this.view().setFloat64(seconds >>> 0, (userCPUTime + systemCPUTime) / 1e6, true);
    this.view().setFloat64(kilobytes >>> 0, maxRSS, true);
  },
  __syscall_open(path, flags, rest) { return this.open(this.pathAt(path), flags, this.argument(rest)); },
  __syscall_openat(folder, path, flags, rest) { return this.open(this.pathAt(path, folder), flags, this.argument(rest)); },
  __syscall_stat64(path, at) { this.writeStat(at, fs.statSync(this.pathAt(path), { bigint: true })); },
  __syscall_lstat64(path, at) { this.writeStat(at, fs.lstatSync(this.pathAt(path), { bigint: true })); },
  __syscall_fstat64(descriptor, at) {
    const folder = this.folder(descriptor);
    this.writeStat(at, folder ? fs.statSync(folder.path, { bigint: true }) : fs.fstatSync(descriptor, { bigint: true }));
  },
  __syscall_fstatat64(folder, path, at, flags) {
    if (flags & AT_EMPTY_PATH && this.textAt(path).length === 0) return this.__syscall_fstat64(folder, at);
    const name = this.pathAt(path, folder);
    this.writeStat(at, flags & AT_SYMLINK_NOFOLLOW ? fs.lstatSync(name, { bigint: true }) : fs.statSync(name, { bigint: true }));
  },
  __syscall_access(path, mode) { fs.accessSync(this.pathAt(path), mode); },
  __syscall_faccessat(folder, path, mode) { fs.accessSync(this.pathAt(path, folder), mode); },
  __syscall_chdir(path) { process.chdir(this.pathAt(path).toString()); },
  __syscall_chmod(path, mode) { fs.chmodSync(this.pathAt(path), mode); },
  __syscall_fchmod(descriptor, mode) { fs.fchmodSync(descriptor, mode); },
  __syscall_fchmodat(folder, path, mode) { fs.chmodSync(this.pathAt(path, folder), mode); },
  __syscall_mkdir(path, mode) { fs.mkdirSync(this.pathAt(path), mode); },
  __syscall_mkdirat(folder, path, mode) { fs.mkdirSync(this.pathAt(path, folder), mode); },
  __syscall_rmdir(path) { fs.rmdirSync(this.pathAt(path)); },
  __syscall_unlink(path) { fs.unlinkSync(this.pathAt(path)); },
  __syscall_unlinkat(folder, path, flags) { (flags & AT_REMOVEDIR ? fs.rmdirSync : fs.unlinkSync)(this.pathAt(path, folder)); },
  __syscall_rename(from, to) { fs.renameSync(this.pathAt(from), this.pathAt(to)); },
  __syscall_renameat(from_folder, from, to_folder, to) { fs.renameSync(this.pathAt(from, from_folder), this.pathAt(to, to_folder)); },
  __syscall_symlink(target, path) { fs.symlinkSync(this.pathAt(target), this.pathAt(path)); },
  __syscall_readlink(path, at, size) { return this.__syscall_readlinkat(AT_FDCWD, path, at, size); },
  __syscall_readlinkat(folder, path, at, size) {
    const target = fs.readlinkSync(this.pathAt(path, folder), { encoding: 'buffer' }).subarray(0, size);
    this.bytesAt(at, size).set(target);
    return target.length;
  },
  __syscall_dup3(from, to) {
    if (!this.virtual(from)) throw new CallError(EINVAL);
    this.copyVirtual(from, to);
    return to;
  },
  __syscall_ftruncate64(descriptor, length) { fs.ftruncateSync(descriptor, Number(length)); },
  __syscall_getcwd(at, size) {
    const folder = Buffer.from(windows ? `/${process.cwd().replaceAll('\\', '/')}\0` : `${process.cwd()}\0`);
    if (folder.length > size) throw new CallError('ERANGE');
    this.bytesAt(at, size).set(folder);
    return folder.length;
  },
  __syscall_getdents64(descriptor, at, size) {
    const folder = this.folder(descriptor);
    if (!folder) throw new CallError('ENOTDIR');
    folder.entries ??= ['.', '..'].map(name => ({ name: Buffer.from(name), isDirectory: () => true }))
      .concat(fs.readdirSync(folder.path, { withFileTypes: true, encoding: 'buffer' }));
    const RECORD = 280, view = this.view();
    let place = at >>> 0;
    const end = place + size;
    for (; folder.next < folder.entries.length && place + RECORD <= end; place += RECORD) {
      const entry = folder.entries[folder.next++];
      this.bytesAt(place, RECORD).fill(0);
      view.setBigUint64(place, BigInt(folder.next), true);
      view.setBigInt64(place + 8, BigInt(folder.next), true);
      view.setUint16(place + 16, RECORD, true);
      view.setUint8(place + 18, KINDS.find(([is]) => entry[is]?.())?.[1] ?? 0);
      this.bytesAt(place + 19, 255).set(entry.name.subarray(0, 255));
    }
    return place - (at >>> 0);
  },
  __syscall_fcntl64(_, command) {
    if (command < 1 || command > 4) throw new CallError(EINVAL);  // F_GETFD, F_SETFD, F_GETFL and F_SETFL have nothing to say
  },
  __syscall_ioctl(descriptor, request, rest) {
    if (request !== TIOCGWINSZ || !isatty(descriptor)) throw new CallError('ENOTTY');
    const view = this.view(), at = this.argument(rest) >>> 0;
    for (const [offset, value] of [[0, 0], [2, this.columns], [4, 0], [6, 0]]) view.setUint16(at + offset, value, true);
  },
  fd_close(descriptor) {
    this.unlock(descriptor);
    if (!this.forget(descriptor)) fs.closeSync(descriptor);
  },
  fd_read(descriptor, list, count, done) {
    const all = this.forBuffers(list, count, buffer => {
      const what = this.virtual(descriptor);
      if (what) return this.readVirtual(what, buffer);
      const read = this.waiting(() => fs.readSync(descriptor, buffer, 0, buffer.length, this.placeOf(descriptor)));
      this.move(descriptor, read);
      return read;
    });
    this.view().setUint32(done >>> 0, all, true);
  },
  fd_write(descriptor, list, count, done) {
    const all = this.forBuffers(list, count, buffer => {
      const what = this.virtual(descriptor);
      if (what) return this.writeVirtual(what, buffer);
      const written = this.waiting(() => fs.writeSync(descriptor, buffer, 0, buffer.length, this.placeOf(descriptor)));
      this.move(descriptor, written);
      return written;
    });
    this.view().setUint32(done >>> 0, all, true);
  },
  fd_seek(descriptor, offset, whence, at) {
    const folder = this.folder(descriptor), what = this.virtual(descriptor), file = what?.memory ? what : this.fileAt(descriptor);
    if (folder) {
      if (offset === 0n && whence === 0) folder.next = 0, folder.entries = null;
    } else if (file && file.at !== null) {
      const from = whence === 0 ? 0 : whence === 1 ? file.at : what ? what.memory.length : fs.fstatSync(descriptor).size;
      if (from + Number(offset) < 0) throw new CallError(EINVAL);
      file.at = from + Number(offset);
    } else {
      throw new CallError('ESPIPE');
    }
    this.view().setBigInt64(at >>> 0, BigInt(file?.at ?? 0), true);
  },
  // A folder cannot be synchronized everywhere.
  fd_sync(descriptor) {
    const folder = this.folder(descriptor);
    if (!folder) return fs.fsyncSync(descriptor);
    if (windows) return;
    const number = fs.openSync(folder.path, 'r');
    try {
      fs.fsyncSync(number);
    } finally {
      fs.closeSync(number);
    }
  },
  // 2: a character device, 3: a folder, 4: a file
  fd_fdstat_get(descriptor, at) {
    const kind = this.folder(descriptor) ? 3 : !this.virtual(descriptor) && isatty(descriptor) ? 2 : 4;
    this.bytesAt(at, 24).fill(0);
    this.view().setUint8(at >>> 0, kind);
  },
};
