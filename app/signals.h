// How signals end the program: with nothing left behind, and by the exit codes of the README.
#pragma once

namespace cloudbake {

/// From now on a signal that ends the program first removes its temporary files. What is ignored stays ignored, as under nohup. A limit on
/// file sizes becomes an error of writing. Standard streams that are closed become ones that cannot be used, so that no other file gets
/// their numbers.
void prepareForSignals();

/// Installs a handler for a signal, unless it is ignored.
void handleSignal(int signal, void (*handler)(int));

/// A handler: removes the temporary files and ends the program by this signal.
void endBySignal(int signal);

}  // namespace cloudbake
