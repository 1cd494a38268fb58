// Checks of numbers on the command line.
#pragma once

namespace CLI {
class Validator;
}

namespace cargobay::cli {

// A number from `lowest` to `highest`. CLI::Range alone lets "nan" pass, which is neither below the
// one nor above the other.
CLI::Validator in_range(double lowest, double highest);

// A whole number of 64 bits without a sign. CLI11 takes -1 for the largest of them, and so it does
// with larger ones.
CLI::Validator whole_number();

}  // namespace cargobay::cli
