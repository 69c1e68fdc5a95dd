// SPDX-License-Identifier: Apache-2.0
// weft_contract MANIFEST_FILE|ROLE/NAME [geometry] ["{parameter: value}"] [deviates "CHECK"]...
// [ROLE/NAME ...]
//
// Checks one component, or each of a library, through the contract, with the laws of geometry if
// they are asked for. What stands behind an id is about this component, else about the first. Exit
// code: 0 all checks hold, 1 one fails, 2 wrong usage, 77 nothing failed and a component was
// skipped.
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <weft/testing/role_contract.hpp>

namespace {

using namespace weft::testing;

constexpr int kHolds = 0, kFails = 1, kUsage = 2, kSkipped = 77;
constexpr unsigned kLongest_s = 300;  ///< a component that takes longer hangs

struct Wanted {
  std::string id;
  ContractOptions options;
  std::string skipped;  ///< why it cannot be checked here; empty where it can
};

std::vector<Wanted> components_named(const std::string& first) {
  if (!first.ends_with(".yaml")) return {{first, {}, {}}};
  ContractOptions options;
  options.plugin_folders = {std::filesystem::absolute(first).parent_path().string()};
  std::vector<Wanted> wanted;
  for (const std::string& id : components_in(first)) wanted.push_back({id, options, {}});
  if (wanted.empty()) throw std::runtime_error(first + ": names no component");
  return wanted;
}

std::vector<Wanted> read_arguments(const std::vector<std::string>& arguments) {
  if (arguments.empty()) {
    throw std::runtime_error(
        "usage: weft_contract MANIFEST_FILE|ROLE/NAME [geometry] [\"{parameter: value}\"] "
        "[deviates \"CHECK\"]... [skipped \"WHY\"] [ROLE/NAME ...]");
  }
  std::vector<Wanted> wanted = components_named(arguments.front());
  auto about = wanted.begin();
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    if (argument == "geometry") {
      for (Wanted& each : wanted) each.options.geometry = true;
    } else if (argument.starts_with("{")) {
      about->options.params = argument;
    } else if (argument == "deviates" && i + 1 < arguments.size()) {
      about->options.deviations.push_back(arguments[++i]);
    } else if (argument == "skipped" && i + 1 < arguments.size()) {
      about->skipped = arguments[++i];
    } else {
      about = std::find_if(wanted.begin(), wanted.end(),
                           [&](const Wanted& each) { return each.id == argument; });
      if (about == wanted.end()) throw std::runtime_error("'" + argument + "' is not checked");
    }
  }
  return wanted;
}

int tell(const std::string& id, const ContractReport& report) {
  for (const std::string& failure : report.failures) std::cout << id << ": " << failure << '\n';
  for (const std::string& known : report.deviations) {
    std::cout << id << " (its page says so): " << known << '\n';
  }
  for (const std::string& line : report.inapplicable) {
    std::cout << id << " (does not apply): " << line << '\n';
  }
  if (!report.failures.empty()) {
    std::cout << id << ": " << report.checks << " checks, " << report.failures.size() << " failures"
              << std::endl;
    return kFails;
  }
  if (!report.skipped.empty()) {
    std::cout << id << ": skipped, " << report.skipped << std::endl;
    return kSkipped;
  }
  std::cout << id << ": " << report.checks << " checks hold" << std::endl;
  return kHolds;
}

/// What the child is doing, readable after its death.
struct Progress {
  char what[256];
  bool is_done;  ///< it was the checks that ended it
};

Progress* told = nullptr;  ///< what the handler reaches

void add(const char* text) {
  const std::size_t length = std::strlen(told->what);
  std::strncpy(told->what + length, text, sizeof(told->what) - 1 - length);
}

/// A component that spoils an input is told so; what becomes of it does not change.
void on_fault(int signal, siginfo_t* info, void*) {
  const SpoiltInput spoilt = spoilt_input_at(info->si_addr);
  if (spoilt.input != nullptr) {
    add(": it ");
    add(spoilt.deed);
    add(spoilt.input);
  }
  std::signal(signal, SIG_DFL);
  if (info->si_code <= 0) raise(signal);  // a fault comes again by itself
}

/// Checks it in a process of its own, so that a crash or a hang is one failure.
int check_isolated(const std::string& id, const ContractOptions& given) {
  void* shared =
      mmap(nullptr, sizeof(Progress), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) throw std::runtime_error("there is no memory");
  auto* progress = static_cast<Progress*>(shared);
  const pid_t child = fork();
  if (child == 0) {
    alarm(kLongest_s);
    told = progress;
    struct sigaction action {};
    action.sa_sigaction = on_fault;
    action.sa_flags = SA_SIGINFO;
    sigaction(SIGSEGV, &action, nullptr);
    ContractOptions options = given;
    options.watch = [&](const std::string& what) {
      std::strncpy(progress->what, what.c_str(), sizeof(progress->what) - 1);
    };
    const int code = tell(id, check_role_contract(id, options));
    std::cout.flush();
    progress->is_done = true;
    _exit(code);
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child) throw std::runtime_error("no process");
  if (WIFEXITED(status) && progress->is_done) return WEXITSTATUS(status);
  if (WIFEXITED(status)) {
    std::cout << id << ": " << progress->what << ": it ended its process with exit code "
              << WEXITSTATUS(status) << std::endl;
    return kFails;
  }
  const int signal = WTERMSIG(status);
  std::cout << id << ": " << progress->what << ": ";
  if (signal == SIGALRM) std::cout << "not done after " << kLongest_s << " s" << std::endl;
  if (signal != SIGALRM) std::cout << "ended by signal " << signal << std::endl;
  return kFails;
}

}  // namespace

int main(int argc, char** argv) try {
  const std::vector<Wanted> wanted = read_arguments({argv + 1, argv + argc});
  std::cout << "seed " << kContractSeed << std::endl;
  int code = kHolds;
  for (const Wanted& each : wanted) {
    const int one = each.skipped.empty() ? check_isolated(each.id, each.options)
                                         : tell(each.id, {0, {}, {}, {}, each.skipped});
    if (code == kHolds || one == kFails) code = one;
  }
  return code;
} catch (const std::exception& wrong) {
  std::cerr << wrong.what() << '\n';
  return kUsage;
}
