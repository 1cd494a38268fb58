// A drive as CSV and as lines of JSON.
//
// Each row or line is a record and begins with the name of its topic. In CSV all topics share one
// header: columns of the same name are one column, and a row leaves the columns of other topics
// empty. docs/recording.md shows both.
#pragma once

#include <memory>

#include "hal/export/record_sink.hpp"

namespace cargobay::hal {

// They write pieces of about 64 KiB.
std::unique_ptr<Export> csv_export(Topics topics, WriteBytes write);
std::unique_ptr<Export> json_lines_export(Topics topics, WriteBytes write);

}  // namespace cargobay::hal
