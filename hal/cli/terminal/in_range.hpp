// Checks for numbers on the command line.
#pragma once

namespace CLI {
class Validator;
}

namespace cargobay::cli {

// A number from `lowest` to `highest`. CLI::Range alone accepts "nan", which is neither below the
// one nor above the other.
CLI::Validator in_range(double lowest, double highest);

// A whole unsigned 64-bit number. CLI11 takes -1, and numbers that are too large, for the largest
// of them.
CLI::Validator whole_number();

}  // namespace cargobay::cli
