#include "hal/cli/drive/drive_recording.hpp"

#include <algorithm>
#include <chrono>
#include <deque>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "hal/export/mcap_export.hpp"
#include "hal/export/retelling.hpp"
#include "hal/recording/flight_recorder.hpp"
#include "hal/recording/recording.hpp"
#include "hal/recording/recording_file.hpp"

namespace cargobay::cli {
namespace {

constexpr const char* kSoftware = "cargobay " CARGOBAY_VERSION;

hal::RecordingHeader header_of(const hal::Robot& robot, const std::string& note) {
  hal::RecordingHeader header = robot.recording_header();
  header.software = kSoftware;
  header.note = note;
  return header;
}

// Each cycle gets a file of its own: FILE for the first link, FILE.2 for the next.
class ReplayableRecording final : public DriveRecording {
 public:
  ReplayableRecording(std::string path, std::string note, Outputs& outputs)
      : path_{std::move(path)}, note_{std::move(note)}, outputs_{outputs} {}

  hal::Result<void> begin_link(const hal::Robot& robot) override {
    std::string key = "--record";
    if (++links_ > 1) {
      key += fmt::format(" number {}", links_);
      if (auto done = outputs_.open(key, fmt::format("{}.{}", path_, links_)); !done) return done;
    }
    auto file = hal::RecordingFile::begin(std::move(*outputs_.take(key)), header_of(robot, note_));
    if (!file) return file.failure();
    file_.emplace(std::move(*file));
    return {};
  }
  void publish() override { file_->publish(); }
  void append(const hal::Robot& robot, const DriveLinks& /*links*/) override {
    file_->append(robot.flight_recorder());
  }
  void end_link(const hal::Robot& robot, const DriveLinks& links) override {
    append(robot, links);
    files_.push_back(file_->path());
    if (written_) written_ = file_->written();
    file_.reset();
  }
  void finish() override {}
  const hal::Result<void>& written() const override { return written_; }
  const std::vector<std::string>& files() const override { return files_; }
  std::string advice(const std::string& file) const override {
    return "look at it with: cargobay plot " + file;
  }

 private:
  std::string path_;
  std::string note_;
  Outputs& outputs_;
  std::optional<hal::RecordingFile> file_{};  // of the link
  int links_ = 0;
  hal::Result<void> written_{};
  std::vector<std::string> files_{};
};

// All links in one file. It is written as the drive goes on, not made of a recording after it: a
// drive that is ended by Ctrl-C has 1.5 s to end, and a crash costs no more than the last chunk.
class McapRecording final : public DriveRecording {
 public:
  McapRecording(std::string note, Outputs& outputs) : note_{std::move(note)}, outputs_{outputs} {}

  hal::Result<void> begin_link(const hal::Robot& robot) override {
    cursor_ = {};
    blocks_.clear();
    if (narrator_) {
      narrator_->begin_link();
      return {};
    }
    const hal::RecordingHeader header = header_of(robot, note_);
    file_.emplace(std::move(*outputs_.take("--record")));
    export_ = hal::mcap_export(hal::kAllTopics, header, kSoftware, [this](std::string_view bytes) {
      return file_->write(bytes, kPatience);
    });
    narrator_.emplace(*export_,
                      hal::Narrator::Origin{.unix_ns = header.started_ns, .time = rt::Clock::now()},
                      header.parameters.loop.estimator.wheel_base_mm);
    return export_->written();
  }
  void publish() override {
    if (!files_.empty() || !written_) return;
    written_ = file_->publish();
    files_.push_back(file_->path());
  }
  void append(const hal::Robot& robot, const DriveLinks& links) override {
    hear(robot, links);
    // The state of a block may have come after it: that block waits.
    if (links.states().empty()) return;
    const rt::TimePoint known = links.states().back().arrival;
    while (!blocks_.empty() && blocks_.front().time < known) tell_block();
  }
  void end_link(const hal::Robot& robot, const DriveLinks& links) override {
    hear(robot, links);
    while (!blocks_.empty()) tell_block();
  }
  void finish() override {
    if (!narrator_) return;
    narrator_->finish();
    const hal::Result<void> done = export_->finish();
    if (written_) written_ = done;
  }
  const hal::Result<void>& written() const override { return written_; }
  const std::vector<std::string>& files() const override { return files_; }
  std::string advice(const std::string& /*file*/) const override { return "open it in Foxglove"; }

 private:
  static constexpr std::chrono::seconds kPatience{1};  // of a pipe

  void hear(const hal::Robot& robot, const DriveLinks& links) {
    for (; states_ < links.states().size(); ++states_) narrator_->know(links.states()[states_]);
    for (; events_ < links.events().size(); ++events_) narrator_->know(links.events()[events_]);
    hal::FlightRecorder::Block block;
    while (robot.flight_recorder().next(cursor_, block)) blocks_.push_back(block);
  }
  void tell_block() {
    hal::EntryReader entries{blocks_.front().entries, blocks_.front().time};
    hal::Entry entry;
    while (entries.next(entry) == hal::EntryReader::Outcome::entry) narrator_->take(entry);
    blocks_.pop_front();
  }

  std::string note_;
  Outputs& outputs_;
  std::optional<hal::OutputFile> file_{};
  std::unique_ptr<hal::Export> export_{};  // to the file
  std::optional<hal::Narrator> narrator_{};
  hal::FlightRecorder::Cursor cursor_{};
  std::deque<hal::FlightRecorder::Block> blocks_{};  // not told yet
  std::size_t states_ = 0;                           // known to the narrator
  std::size_t events_ = 0;
  hal::Result<void> written_{};
  std::vector<std::string> files_{};
};

bool is_mcap(std::string path) {
  std::ranges::transform(path, path.begin(), [](unsigned char c) {
    return static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  });
  return path.ends_with(".mcap");
}

}  // namespace

std::unique_ptr<DriveRecording> drive_recording(const std::string& path, const std::string& note,
                                                Outputs& outputs) {
  if (path.empty()) return nullptr;
  if (is_mcap(path)) return std::make_unique<McapRecording>(note, outputs);
  return std::make_unique<ReplayableRecording>(path, note, outputs);
}

}  // namespace cargobay::cli
