// The subcommands. Each adds itself to the command line and says how to run it.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace cargobay::cli {

// What to do, as chosen on the command line; returns the exit code.
using Action = std::function<int()>;

void add_drive(CLI::App& app, Action& chosen);
void add_replay(CLI::App& app, Action& chosen);
void add_plot(CLI::App& app, Action& chosen);
void add_export(CLI::App& app, Action& chosen);
void add_calibrate(CLI::App& app, Action& chosen);
void add_bringup(CLI::App& app, Action& chosen);
void add_ports(CLI::App& app, Action& chosen);
void add_pins(CLI::App& app, Action& chosen);
void add_doctor(CLI::App& app, Action& chosen);
void add_jitter(CLI::App& app, Action& chosen);
void add_jitter_compare(CLI::App& jitter, Action& chosen);
void add_budget(CLI::App& app, Action& chosen);
void add_sensors(CLI::App& app, Action& chosen);
void add_encode(CLI::App& app, Action& chosen);
void add_decode(CLI::App& app, Action& chosen);
void add_send(CLI::App& app, Action& chosen);
void add_sim(CLI::App& app, Action& chosen);
void add_serve(CLI::App& app, Action& chosen);
void add_top(CLI::App& app, Action& chosen);
void add_teleop(CLI::App& app, Action& chosen);

}  // namespace cargobay::cli
