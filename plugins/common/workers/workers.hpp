// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace weft {

/// Threads that wait for work during the lifetime of this object, because starting one takes longer
/// than many jobs. They belong to one instance of a component, and do one run at a time.
class Workers {
 public:
  using Job = std::function<void(int worker)>;

  Workers() = default;
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  /// Calls job(0) on the caller's thread and job(1) ... job(count - 1) on others, and returns when
  /// all are done. The result of the jobs must not depend on how they divide the work. Rethrows the
  /// exception of the lowest worker that threw.
  void run(int count, const Job& job);

 private:
  void work(int worker);
  void call(int worker);

  std::mutex mutex_;
  std::condition_variable begun_, done_;
  std::vector<std::thread> threads_;
  std::vector<std::exception_ptr> errors_;
  const Job* job_ = nullptr;
  std::uint64_t round_ = 0;
  int count_ = 0, running_ = 0;
  bool closing_ = false;
};

}  // namespace weft
