#pragma once

#include <istream>
#include <optional>
#include <string>

namespace clearway::bench {

/// What the program runs on, as far as the kernel says.
struct Machine {
  std::string cpu = "unknown CPU";
  std::string vectors = "SSE2";  ///< the widest instructions that our hot loops use here
  unsigned cores = 0;
  double memory_gb = 0.0;  ///< 10^9 bytes
};

Machine this_machine();

/// "model name" of /proc/cpuinfo; empty where there is none.
std::string cpu_model(std::istream& cpuinfo);

/// How busy the machine is at one time.
struct MachineLoad {
  double average = 0.0;  ///< load average over one minute
  double stolen = 0.0;   ///< clock ticks since boot in which the host ran someone else
  double ticks = 0.0;    ///< all of them
};

MachineLoad machine_load();

/// Of the first lines of /proc/loadavg and /proc/stat.
MachineLoad read_load(std::istream& loadavg, std::istream& stat);

/// Share of the cores' time that the host took away between two looks; none where the kernel does not say.
std::optional<double> stolen_share(const MachineLoad& before, const MachineLoad& after);

}  // namespace clearway::bench
