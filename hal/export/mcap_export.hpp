// A drive as MCAP, for Foxglove, PlotJuggler and other readers: the topics as in the lines of JSON,
// and beside them /pose, /tf, /path and /log in Foxglove's own schemas, so that its panels show the
// robot and what happened without being set up.
#pragma once

#include <memory>
#include <string>

#include "hal/export/record_sink.hpp"
#include "hal/recording/recording_header.hpp"

namespace cargobay::hal {

// `software`: what writes it, with its version. Of the header, what it says of the drive becomes
// the file's metadata; it need not outlive the call. /pose, /tf and /path come with the states,
// /log with the events.
std::unique_ptr<Export> mcap_export(Topics topics, const RecordingHeader& header,
                                    const std::string& software, WriteBytes write);

}  // namespace cargobay::hal
