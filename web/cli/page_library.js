// What the whole program asks its host (core/wasm/host.h), in a page: files are Emscripten's, in memory, and there is one process.
/* global LibraryManager, mergeInto */
const MOST = 2 ** 32;  // bytes of a memory
const answers = {
  cloudbake_machine_memory: MOST, cloudbake_memory_limit: MOST, cloudbake_limit_memory: 0, cloudbake_processors: 1,
  cloudbake_process_number: 1, cloudbake_is_running: 0, cloudbake_is_helper: 0, cloudbake_temporary: 0, cloudbake_lock: 0,
  cloudbake_machine_name: 0, cloudbake_usage: 0, cloudbake_note_signals: 0, cloudbake_noted_signal: 0,
};
// A page starts no process.
const missing = ['memory_file', 'message_kind', 'message_size', 'pipe', 'receive', 'send', 'start', 'start_helper', 'stop', 'take_message',
  'wait', 'wait_for_bytes'];
mergeInto(LibraryManager.library, Object.fromEntries([
  ...Object.entries(answers).map(([name, answer]) => [name, new Function(`return ${answer};`)]),
  ...missing.map(name => [`cloudbake_${name}`, new Function(`throw new Error('cloudbake_${name}: not in a page');`)]),
]));
