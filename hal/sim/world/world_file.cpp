// Worlds as text: World::parse() and World::load().
#include <algorithm>
#include <array>
#include <numbers>
#include <span>

#include "hal/file/read_input.hpp"
#include "hal/sim/next_word.hpp"
#include "hal/sim/world/world.hpp"

namespace cargobay::hal::sim {

namespace {

struct Kind {
  std::string_view name;
  std::size_t numbers;
  std::string_view arguments;
  void (*add)(World& world, std::span<const double> numbers);
};

constexpr std::size_t kMostNumbers = 4;
constexpr double kFarthest = 1e6;  // a kilometre

WorldPose pose(std::span<const double> n) { return {n[0], n[1], n[2] * std::numbers::pi / 180.0}; }
Rectangle rectangle(std::span<const double> n) { return {{n[0], n[1]}, n[2], n[3]}; }
Beam beam(std::span<const double> n) { return {{n[0], n[1]}, n[2]}; }

using Numbers = std::span<const double>;

constexpr std::array<Kind, 7> kKinds{{
    {"wall", 4, "X1 Y1 X2 Y2",
     [](World& world, Numbers n) { world.walls.push_back({{n[0], n[1]}, {n[2], n[3]}}); }},
    {"box", 4, "X Y WIDTH HEIGHT",
     [](World& world, Numbers n) { world.boxes.push_back(rectangle(n)); }},
    {"post", 3, "X Y RADIUS",
     [](World& world, Numbers n) { world.posts.push_back({{n[0], n[1]}, n[2]}); }},
    {"cliff", 4, "X Y WIDTH HEIGHT",
     [](World& world, Numbers n) { world.cliffs.push_back(rectangle(n)); }},
    {"virtual-wall", 3, "X Y HEADING",
     [](World& world, Numbers n) { world.virtual_walls.push_back(beam(n)); }},
    {"home-base", 3, "X Y HEADING", [](World& world, Numbers n) { world.home_base = beam(n); }},
    {"start", 3, "X Y HEADING", [](World& world, Numbers n) { world.starts.push_back(pose(n)); }},
}};

// What is wrong with the line; empty if nothing is.
std::string add_line(std::string_view line, World& world) {
  std::string_view rest = line.substr(0, std::min(line.find('#'), line.size()));
  const std::string_view name = next_word(rest);
  if (name.empty()) return {};
  const auto* const kind = std::find_if(kKinds.begin(), kKinds.end(),
                                        [name](const Kind& each) { return each.name == name; });
  if (kind == kKinds.end()) {
    return "'" + std::string{name} +
           "' is not one of wall, box, post, cliff, virtual-wall, home-base, start";
  }
  std::string usage =
      "the usage is '" + std::string{name} + " " + std::string{kind->arguments} + "'";
  std::array<double, kMostNumbers> numbers{};
  for (std::size_t i = 0; i < kind->numbers; ++i) {
    const std::optional<double> number = to_number(next_word(rest), -kFarthest, kFarthest);
    if (!number) return usage;
    numbers[i] = *number;
  }
  if (!no_more_words(rest)) return usage;
  kind->add(world, numbers);
  return {};
}

}  // namespace

Result<World> World::parse(std::string_view text) {
  World world;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t length = std::min(text.find('\n'), text.size());
    const std::string problem = add_line(text.substr(0, length), world);
    if (!problem.empty()) {
      return Failure{.message = "line " + std::to_string(number) + ": " + problem};
    }
    text.remove_prefix(std::min(length + 1, text.size()));
  }
  return world;
}

Result<World> World::load(const std::string& path) {
  const auto text = read_input(path, {.most_bytes = kMostConfigBytes});
  if (!text) {
    return Failure{.message = "cannot read the world " + path + ": " + text.failure().message,
                   .code = text.failure().code};
  }
  Result<World> world = parse(*text);
  if (!world) return Failure{.message = path + ", " + world.failure().message};
  return world;
}

}  // namespace cargobay::hal::sim
