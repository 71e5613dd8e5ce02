// What the program for Node asks its host, web/cli/host.mjs. Only for sources in folders wasm/.
#pragma once

#include <cstddef>

extern "C" {

/// The memory never grows beyond so many bytes.
void cloudbake_limit_memory(double bytes);
double cloudbake_memory_limit();
/// Bytes of memory of the machine, or of its part that this process may have.
double cloudbake_machine_memory();
/// How many processors this process may use.
int cloudbake_processors();

/// Seconds of the processor, and the most kilobytes of memory, that the process has used.
void cloudbake_usage(double* seconds, double* kilobytes);

/// Whether this temporary file exists now; the host removes those that exist when a signal ends the process.
void cloudbake_temporary(const char* path, int exists);
/// From now on the first signal that asks the process to end is only noted. Then its number is returned, 0 before.
void cloudbake_note_signals();
int cloudbake_noted_signal();

/// Starts a copy of the program in a thread. `words`: its command line without the program's name, each with a NUL behind it, and another
/// NUL. Returns its number, above 0.
int cloudbake_start(const char* words);
/// Ends it at once.
void cloudbake_stop(int process);
/// Sends bytes to a process that was started, or with 0 to the one that started this one.
void cloudbake_send(int process, const void* bytes, size_t size);
/// Waits for a message or for the end of a process that was started. Returns whose it is, −1 if none came in this time; below 0: for ever.
int cloudbake_receive(double milliseconds);
/// Of what was received: 0 bytes, 1 it ended with a code, 2 it crashed; the bytes, those of the exit code as text, or what happened.
int cloudbake_message_kind();
size_t cloudbake_message_size();
void cloudbake_take_message(void* bytes);

/// Keeps all of standard input, so that this process and those that it starts can read it from its start. Returns 0 or an errno.
int cloudbake_keep_input();

/// Locks an open file until it is closed or this process has ended, alone or with others, against processes of this machine that do the same.
/// Returns 0 or an errno.
int cloudbake_lock(int file, int alone);

/// Whether a process of this number runs on this machine.
int cloudbake_is_running(int process);
int cloudbake_process_number();
/// The name of this machine.
void cloudbake_machine_name(char* name, size_t size);

}  // extern "C"
