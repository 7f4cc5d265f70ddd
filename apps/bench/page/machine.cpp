#include "apps/bench/page/machine.hpp"

#include <unistd.h>

#include <fstream>
#include <thread>

#include "mapping/system/instruction_set.hpp"

namespace clearway::bench {

std::string cpu_model(std::istream& cpuinfo) {
  for (std::string line; std::getline(cpuinfo, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return {};
}

Machine this_machine() {
  Machine machine;
  std::ifstream cpuinfo("/proc/cpuinfo");
  if (const std::string model = cpu_model(cpuinfo); !model.empty()) machine.cpu = model;
  const InstructionSet widest = best_instruction_set();
  if (widest != InstructionSet::portable)
    machine.vectors = widest == InstructionSet::avx512 ? "AVX-512" : "AVX2";
  machine.cores = std::thread::hardware_concurrency();
  machine.memory_gb =
      1e-9 * static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  return machine;
}

MachineLoad read_load(std::istream& loadavg, std::istream& stat) {
  MachineLoad load;
  loadavg >> load.average;
  std::string cpu;
  stat >> cpu;  // user nice system idle iowait irq softirq steal
  double ticks = 0.0;
  for (int field = 0; field < 8 && stat >> ticks; ++field) {
    load.ticks += ticks;
    if (field == 7) load.stolen = ticks;
  }
  return load;
}

MachineLoad machine_load() {
  std::ifstream loadavg("/proc/loadavg"), stat("/proc/stat");
  return read_load(loadavg, stat);
}

std::optional<double> stolen_share(const MachineLoad& before, const MachineLoad& after) {
  if (!(after.ticks > before.ticks)) return std::nullopt;
  return (after.stolen - before.stolen) / (after.ticks - before.ticks);
}

}  // namespace clearway::bench
