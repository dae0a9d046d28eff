#pragma once
// Errors. A library never aborts; inside solves, fits and scans a failure is a value (a status), and these
// two types are for what stops the whole command.

#include <stdexcept>
#include <string>

namespace rodwake {

/// The user's input cannot be used: scene, data file or command line. The program exits with 2.
/// The message says where (file:line:column), what was found, what is legal and what to do next.
class InputError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// The input was fine but the work could not be finished: unwritable output, failed solve. The program exits
/// with 1.
class RunError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// What an exception says to the user: its text, or words where the library that threw it has none.
std::string describe(const std::exception& error);

} // namespace rodwake
