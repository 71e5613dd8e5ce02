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
/// Seconds of the processor, and the most kilobytes of memory, that the whole process has used.
void cloudbake_usage(double* seconds, double* kilobytes);

/// Whether this temporary file exists now; the host removes those that exist when a signal ends the process.
void cloudbake_temporary(const char* path, int exists);
/// From now on the first signal that asks the process to end is only noted. Then its number is returned, 0 before.
void cloudbake_note_signals();
int cloudbake_noted_signal();

/// Locks an open file until it is closed or this process has ended, alone or with others, against processes of this machine that do the
/// same. Returns 0 or an errno.
int cloudbake_lock(int file, int alone);
/// Whether a process of this number runs on this machine.
int cloudbake_is_running(int process);
int cloudbake_process_number();
/// The name of this machine.
void cloudbake_machine_name(char* name, size_t size);

// Copies of the program in threads of Node. For the program they are processes.

/// Starts a copy and returns its number. `words`: its command line without the program's name, each word with a NUL behind it. `inherited`:
/// pairs of a descriptor there and one here, or −1.
int cloudbake_start(const char* words, int word_count, const int* inherited, int inherited_count);
/// Ends it at once.
void cloudbake_stop(int process);
/// Waits for its end. Returns its exit code, and the signal that would have ended a process.
int cloudbake_wait(int process, int* signal);
/// The ends to read and to write of a pipe to this copy.
void cloudbake_pipe(int* ends);
/// A file of these bytes.
int cloudbake_memory_file(const void* bytes, size_t size);
/// Whether a pipe has bytes, or is closed, before the time is over.
int cloudbake_wait_for_bytes(int pipe, double milliseconds);

// Copies of the program that help this one: they have its command line, and messages in both directions.

int cloudbake_start_helper();
int cloudbake_is_helper();
/// To a helper, or with 0 from a helper to the copy that started it.
void cloudbake_send(int process, const void* bytes, size_t size);
/// Waits for a message, for the end of a helper, or for a signal. Returns whose it is, 0 for the copy that started this one, −1 for a
/// signal.
int cloudbake_receive();
/// Of what was received: 0 bytes, 1 it ended with a code, 2 it crashed; the bytes, those of the exit code as text, or what happened.
int cloudbake_message_kind();
size_t cloudbake_message_size();
void cloudbake_take_message(void* bytes);

}  // extern "C"
