// SPDX-License-Identifier: Apache-2.0
// weft-worker SOCKET INPUTS OUTPUTS: started by a host, with descriptors, for an isolated stage.
#include <unistd.h>

#include <cstdlib>

#include "host/records/memory_pool.hpp"
#include "host/serving/server.hpp"
#include "process/supervisor.hpp"

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  weft::process::go_on_supervised(STDOUT_FILENO);
  weft::host::keep_freed_memory();
  weft::host::serve_host(std::atoi(argv[1]), std::atoi(argv[2]), std::atoi(argv[3]));
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(WEFT_COVERAGE)
  _exit(0);  // handlers and destructors that libraries have registered could crash or hang
#endif
  return 0;
}
