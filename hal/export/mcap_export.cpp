#include "hal/export/mcap_export.hpp"

#include <array>
#include <optional>
#include <utility>

#include "hal/export/foxglove_schemas.hpp"
#include "hal/export/json_schema.hpp"
#include "hal/export/mcap_writer.hpp"

namespace cargobay::hal {
namespace {

constexpr double kWayEveryS = 2.0;

class McapExport final : public Export {
 public:
  McapExport(Topics topics, const RecordingHeader& header, const std::string& software,
             WriteBytes write)
      : topics_{topics}, file_{std::move(write), software} {
    file_.metadata("cargobay", {{"note", header.note},
                                {"software", header.software},
                                {"baud", std::to_string(header.baud)}});
    for (std::size_t i = 0; i < kTopics; ++i) {
      const TopicInfo& topic = info(static_cast<Topic>(i));
      if (!topics.has(static_cast<Topic>(i))) continue;
      const auto schema =
          file_.add_schema("cargobay." + std::string{topic.name}, json_schema(topic));
      channels_[i] = file_.add_channel("/" + std::string{topic.name}, schema);
    }
    if (topics.has(Topic::states)) {
      pose_ = add("/pose", pose_in_frame_schema());
      transform_ = add("/tf", frame_transform_schema());
      way_ = add("/path", poses_in_frame_schema());
    }
    if (topics.has(Topic::events)) log_ = add("/log", log_schema());
  }

  void take(const StateRecord& record) override {
    if (!put(Topic::states, state_columns(), record)) return;
    if (record.extent != StateRecord::Extent::whole) return;
    const std::int64_t unix_ns = record.stamp.unix_ns;
    const rt::OdometryPose& pose = record.state.pose;
    append_pose_in_frame(begin(), unix_ns, pose);
    end(pose_, unix_ns);
    append_frame_transform(begin(), unix_ns, pose);
    end(transform_, unix_ns);
    way_so_far_.add(pose);
    if (way_told_s_ && record.stamp.time_s - *way_told_s_ < kWayEveryS) return;
    way_told_s_ = record.stamp.time_s;
    append_poses_in_frame(begin(), unix_ns, way_so_far_.poses());
    end(way_, unix_ns);
  }
  void take(const SensorRecord& record) override { put(Topic::sensors, sensor_columns(), record); }
  void take(const EventRecord& record) override {
    if (!put(Topic::events, event_columns(), record)) return;
    append_log(begin(), record.stamp.unix_ns, record.event);
    end(log_, record.stamp.unix_ns);
  }
  void take(const CommandRecord& record) override {
    put(Topic::commands, command_columns(), record);
  }
  const Result<void>& written() const override { return file_.written(); }
  Result<void> finish() override { return file_.finish(); }

 private:
  McapWriter::Channel add(std::string_view topic, const FoxgloveSchema& schema) {
    return file_.add_channel(topic, file_.add_schema(schema.name, schema.json));
  }
  // False if the topic is left out.
  template <typename Record>
  bool put(Topic topic, const Columns<Record>& columns, const Record& record) {
    if (!topics_.has(topic)) return false;
    append_json(begin(), columns, record);
    end(channels_[static_cast<std::size_t>(topic)], record.stamp.unix_ns);
    return true;
  }
  std::string& begin() {
    message_.clear();
    return message_;
  }
  void end(McapWriter::Channel channel, std::int64_t unix_ns) {
    file_.message(channel, static_cast<std::uint64_t>(unix_ns), message_);
  }

  Topics topics_;
  McapWriter file_;
  std::array<McapWriter::Channel, kTopics> channels_{};
  McapWriter::Channel pose_ = 0;
  McapWriter::Channel transform_ = 0;
  McapWriter::Channel way_ = 0;
  McapWriter::Channel log_ = 0;
  WaySoFar way_so_far_{};
  std::optional<double> way_told_s_{};
  std::string message_{};
};

}  // namespace

std::unique_ptr<Export> mcap_export(Topics topics, const RecordingHeader& header,
                                    const std::string& software, WriteBytes write) {
  return std::make_unique<McapExport>(topics, header, software, std::move(write));
}

}  // namespace cargobay::hal
