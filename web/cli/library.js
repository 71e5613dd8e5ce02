// What Emscripten's libraries call, as functions of web/cli/host.mjs, in place of Emscripten's own file system: files and folders are those
// of the machine. An object `host` comes with the module.
/* global LibraryManager, mergeInto */
const calls = {
  __syscall_chdir: 1, __syscall_chmod: 2, __syscall_faccessat: 4, __syscall_fchmod: 2, __syscall_fchmodat: 3, __syscall_fcntl64: 3,
  __syscall_fstat64: 2, __syscall_fstatat64: 4, __syscall_ftruncate64: 2, __syscall_getcwd: 2, __syscall_getdents64: 3, __syscall_ioctl: 3,
  __syscall_lstat64: 2, __syscall_mkdir: 2, __syscall_mkdirat: 3, __syscall_open: 3, __syscall_openat: 4, __syscall_readlink: 3,
  __syscall_readlinkat: 4, __syscall_rename: 2, __syscall_renameat: 4, __syscall_rmdir: 1, __syscall_stat64: 2, __syscall_symlink: 2,
  __syscall_unlink: 1, __syscall_unlinkat: 3, __syscall_access: 2, __syscall_dup3: 3,
  fd_close: 1, fd_fdstat_get: 2, fd_read: 4, fd_seek: 4, fd_sync: 1, fd_write: 4,
  cloudbake_is_helper: 0, cloudbake_is_running: 1, cloudbake_limit_memory: 1, cloudbake_lock: 2, cloudbake_machine_memory: 0,
  cloudbake_machine_name: 2, cloudbake_memory_file: 2, cloudbake_memory_limit: 0, cloudbake_message_kind: 0, cloudbake_message_size: 0,
  cloudbake_note_signals: 0, cloudbake_noted_signal: 0, cloudbake_pipe: 1, cloudbake_process_number: 0, cloudbake_processors: 0,
  cloudbake_receive: 0, cloudbake_send: 3, cloudbake_start: 4, cloudbake_start_helper: 0, cloudbake_stop: 1, cloudbake_take_message: 1,
  cloudbake_temporary: 2, cloudbake_usage: 2, cloudbake_wait: 2, cloudbake_wait_for_bytes: 2,
};
const library = {
  $Host__deps: ['$ENV', '$ERRNO_CODES'],
  $Host__postset: `
    Host = Module["host"];
    Host.errno = () => ERRNO_CODES;
    Host.bytes = () => HEAPU8;
    Object.assign(ENV, Host.environment());`,
  $Host: {},
  __pthread_create_js: new Function('thread', 'attributes', 'routine', 'argument', `
    return Host.startThread({ thread, routine, argument, memory: wasmMemory });`),
  __pthread_create_js__deps: ['$Host'],
  emscripten_num_logical_cores: new Function('return Host.threadCount();'),
  emscripten_num_logical_cores__deps: ['$Host'],
  emscripten_resize_heap__deps: ['$Host', '$emscripten_realloc_buffer'],
  emscripten_resize_heap: new Function('size', `
    const grown = Host.grownMemory(size >>> 0, HEAPU8.length);
    return grown > 0 && emscripten_realloc_buffer(grown);`),
};
for (const [name, count] of Object.entries(calls)) {
  const parameters = ['a', 'b', 'c', 'd'].slice(0, count).join(', ');
  library[name] = new Function(parameters, `return Host.${name}(${parameters});`);
  library[`${name}__deps`] = ['$Host'];
  library[`${name}__postset`] = '';
}
mergeInto(LibraryManager.library, library);
