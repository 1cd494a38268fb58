// Standard input, output and error as the command can rely on them.
#pragma once

#include <system_error>

namespace cargobay::cli {

// First of all in main(). Where one of the descriptors 0 to 2 is closed, no port or file of ours
// may get its number: it becomes one that can be neither read nor written. False where even that
// cannot be done.
[[nodiscard]] bool open_standard_descriptors();

// After that: what is printed to stdout and stderr never throws, and never holds a signal up. Where
// it cannot be written the rest is dropped, and output_error() says why; a pipe or terminal that
// takes nothing is waited for until one of StopSignals' comes.
void rely_on_standard_streams();

// What went wrong with standard output, if anything did. Any thread.
std::error_code output_error();

}  // namespace cargobay::cli
