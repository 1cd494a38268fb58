// Counters and histograms: the loop's, and the program's own.
#include <algorithm>
#include <memory>

#include "hal/c/cargobay.h"
#include "hal/c/durations.hpp"
#include "hal/c/errors.hpp"
#include "hal/c/robot_object.hpp"
#include "hal/c/sized.hpp"
#include "hal/c/text.hpp"
#include "rt/histogram.hpp"

namespace cargobay::c {
namespace {

using HistogramTable = HandleTable<rt::Histogram, HandleKind::histogram>;

HistogramTable& histograms() {
  static constinit HistogramTable table;  // as robots()
  return table;
}

int bad_histogram(const cargobay_histogram* histogram) noexcept {
  return bad_handle(histogram, HandleKind::histogram);
}

cargobay_statistics statistics_of(const RobotObject& object, const Session& session) {
  const hal::CycleCounters counters = session.robot->cycle().counters();
  const auto state = session.robot->cycle().state();
  cargobay_statistics known{};
  if (session.grant) {
    known.scheduler = session.grant->fifo ? 1 : 0;
    known.priority = session.grant->priority;
    known.memory_locked = session.grant->memory_locked ? 1 : 0;
  }
  known.ticks = state ? state->tick : 0;
  known.frames_good = counters.frames.good;
  known.frames_bad = counters.frames.bad;
  known.frames_lost = counters.frames.lost;
  known.frames_late = counters.frames.late;
  known.overruns_wait = counters.overruns.wait;
  known.overruns_read = counters.overruns.read;
  known.overruns_control = counters.overruns.user;
  known.overruns_write = counters.overruns.write;
  known.controls_refused = counters.refused;
  known.commands_unsent = counters.unsent;
  known.commands_withheld = counters.withheld;
  known.events = static_cast<std::uint64_t>(object.events.last());
  return known;
}

std::int64_t time_of(std::uint64_t value) { return static_cast<std::int64_t>(value); }

cargobay_distribution distribution_of(const rt::Histogram& histogram) {
  cargobay_distribution known{};
  known.count = histogram.count();
  known.min_ns = time_of(histogram.min());
  known.p50_ns = time_of(histogram.percentile(50.0));
  known.p90_ns = time_of(histogram.percentile(90.0));
  known.p99_ns = time_of(histogram.percentile(99.0));
  known.p999_ns = time_of(histogram.percentile(99.9));
  known.max_ns = time_of(histogram.max());
  known.mean_ns = histogram.mean();
  return known;
}

}  // namespace
}  // namespace cargobay::c

using namespace cargobay::c;  // NOLINT(google-build-using-namespace): what C sees stands below
using cargobay::rt::Histogram;

extern "C" {

int cargobay_get_statistics(struct cargobay_robot* robot, struct cargobay_statistics* statistics) {
  const RobotUse use = robots().use(robot);
  if (!use) return bad_robot(robot);
  const SessionUse session{*use};
  if (!session) return no_session();
  if (const int early = session->must_be_started(); early != CARGOBAY_OK) return early;
  return give(statistics_of(*use, *session), statistics) ? static_cast<int>(CARGOBAY_OK)
                                                         : bad_argument(kBadOut);
}

int cargobay_get_missing_rights(struct cargobay_robot* robot, char* text, size_t text_size) {
  if (text == nullptr)
    return bad_argument("`text` is NULL: give it room; 1500 characters are enough");
  return guarded([&] {
    const RobotUse use = robots().use(robot);
    if (!use) return bad_robot(robot);
    const SessionUse session{*use};
    if (!session) return no_session();
    if (const int early = session->must_be_started(); early != CARGOBAY_OK) return early;
    const auto lines = session->grant ? cargobay::rt::explain(*session->grant) : std::string{};
    return copy_text(lines, text, text_size);
  });
}

int cargobay_histogram_open(struct cargobay_histogram** histogram) {
  if (histogram == nullptr)
    return bad_argument("`histogram` is NULL: give the address of a pointer");
  *histogram = nullptr;
  return guarded([&] {
    *histogram = static_cast<cargobay_histogram*>(histograms().open(std::make_unique<Histogram>()));
    if (*histogram != nullptr) return static_cast<int>(CARGOBAY_OK);
    return fail(CARGOBAY_E_LIMIT, "64 histograms are open; close those that are not used");
  });
}

int cargobay_histogram_close(struct cargobay_histogram* histogram) {
  if (histogram == nullptr) return CARGOBAY_OK;
  return guarded([&] {
    const auto closed = histograms().close(histogram, [](Histogram&) { return true; });
    return closed ? static_cast<int>(CARGOBAY_OK) : bad_histogram(histogram);
  });
}

int cargobay_histogram_record(struct cargobay_histogram* histogram, int64_t time_ns) {
  const auto use = histograms().use(histogram);
  if (!use) return bad_histogram(histogram);
  use->record(static_cast<std::uint64_t>(std::clamp<std::int64_t>(time_ns, 0, kLongestNs)));
  return CARGOBAY_OK;
}

int cargobay_histogram_get(struct cargobay_histogram* histogram,
                           struct cargobay_distribution* distribution) {
  return guarded([&] {
    const auto use = histograms().use(histogram);
    if (!use) return bad_histogram(histogram);
    const auto copy = std::make_unique<Histogram>(use->snapshot());
    return give(distribution_of(*copy), distribution) ? static_cast<int>(CARGOBAY_OK)
                                                      : bad_argument(kBadOut);
  });
}

int cargobay_histogram_get_percentile(struct cargobay_histogram* histogram, double percent,
                                      int64_t* time_ns) {
  if (time_ns == nullptr) return bad_argument("`time_ns` is NULL: give the address of an int64_t");
  const bool sensible = percent >= 0.0 && percent <= 100.0;  // false for NaN
  if (!sensible) return bad_argument("`percent` must be 0 to 100");
  return guarded([&] {
    const auto use = histograms().use(histogram);
    if (!use) return bad_histogram(histogram);
    const auto copy = std::make_unique<Histogram>(use->snapshot());
    *time_ns = time_of(copy->percentile(percent));
    return static_cast<int>(CARGOBAY_OK);
  });
}

int cargobay_copy_histogram(struct cargobay_robot* robot, int measure,
                            struct cargobay_histogram* histogram) {
  if (measure != CARGOBAY_MEASURE_PERIOD && measure != CARGOBAY_MEASURE_FRAME_TO_COMMAND)
    return bad_argument("`measure` must be one of enum cargobay_measure");
  return guarded([&] {
    const RobotUse use = robots().use(robot);
    if (!use) return bad_robot(robot);
    const SessionUse session{*use};
    if (!session) return no_session();
    if (const int early = session->must_be_started(); early != CARGOBAY_OK) return early;
    const auto into = histograms().use(histogram);
    if (!into) return bad_histogram(histogram);
    const cargobay::hal::ControlCycle& cycle = session.cycle();
    *into = measure == CARGOBAY_MEASURE_PERIOD ? cycle.period_ns().snapshot()
                                               : cycle.frame_to_command_ns().snapshot();
    return static_cast<int>(CARGOBAY_OK);
  });
}

}  // extern "C"
