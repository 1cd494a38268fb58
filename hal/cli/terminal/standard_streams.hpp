// Makes standard input, output and error reliable for the command.
#pragma once

#include <system_error>

namespace cargobay::cli {

// First of all in main(). If one of the descriptors 0 to 2 is closed, no port or file of ours may
// get its number: it is opened such that it can be neither read nor written. False if even that
// fails.
[[nodiscard]] bool open_standard_descriptors();

// Call it next. From then on printing to stdout and stderr never throws, and never delays a signal.
// If output cannot be written, the rest is dropped, output_error() says why, and StopSignals end
// the command; a pipe or terminal that takes nothing is waited for until one of them comes.
void rely_on_standard_streams();

// Nothing reads standard output any more, and that ends the command: from here on everything is
// dropped. Any thread.
void note_output_is_gone();

// What went wrong with standard output, if anything did. Any thread.
std::error_code output_error();

}  // namespace cargobay::cli
