// SPDX-License-Identifier: Apache-2.0
// weft-worker SOCKET INPUTS OUTPUTS: started by a host, with descriptors, for an isolated stage.
#include <unistd.h>

#include <cstdlib>

#include "host/serving/server.hpp"
#include "process/supervisor.hpp"

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  weft::process::go_on_supervised(STDOUT_FILENO);
  weft::host::serve_host(std::atoi(argv[1]), std::atoi(argv[2]), std::atoi(argv[3]));
  return 0;
}
