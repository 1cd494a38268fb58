// Exit codes of the command.
#pragma once

namespace cargobay::cli {

inline constexpr int kSuccess = 0;
inline constexpr int kFailure = 1;     // what was asked for could not be done; one line says why
inline constexpr int kUsageError = 2;  // the command line makes no sense
// A signal N ended the run, with its results printed: 128 + N, as in shells.
inline constexpr int kSignalled = 128;

}  // namespace cargobay::cli
