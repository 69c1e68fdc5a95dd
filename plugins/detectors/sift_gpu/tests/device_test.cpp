// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <thread>

#include "program.hpp"
#include "tests/adversarial_images.hpp"
#include "tests/kernel_runner.hpp"

namespace weft::sift_gpu {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

bool is_gpu(const cl::Device& device) {
  return (device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_GPU) != 0;
}

std::string in_capitals(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

TEST(Devices, GpusComeFirstAndAnEmptyNameTakesTheFirst) {
  const std::vector<cl::Device> devices = all_devices();
  ASSERT_FALSE(devices.empty());
  EXPECT_TRUE(std::is_partitioned(devices.begin(), devices.end(), is_gpu));
  EXPECT_EQ((*choose(""))(), devices.front()());
}

TEST(Devices, AreChosenByIndex) {
  const std::vector<cl::Device> devices = all_devices();
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const auto chosen = choose(std::to_string(i));
    ASSERT_TRUE(chosen) << chosen.error().message;
    EXPECT_EQ((*chosen)(), devices[i]());
  }
  EXPECT_FALSE(choose(std::to_string(devices.size()))) << "though names and vendors have digits";
}

TEST(Devices, AreChosenByAPartOfTheirNameOrVendorInAnyCase) {
  for (const cl::Device& device : all_devices()) {
    const std::string name = device.getInfo<CL_DEVICE_NAME>();
    const std::string vendor = device.getInfo<CL_DEVICE_VENDOR>();
    for (const std::string& part : {name, name.substr(1, 6), vendor, vendor.substr(1, 4)}) {
      for (const std::string& wanted : {part, in_capitals(part)}) {
        const auto chosen = choose(wanted);
        ASSERT_TRUE(chosen) << wanted;
        const std::string names =
            chosen->getInfo<CL_DEVICE_NAME>() + " / " + chosen->getInfo<CL_DEVICE_VENDOR>();
        EXPECT_THAT(in_capitals(names), HasSubstr(in_capitals(part)));
      }
    }
  }
}

TEST(Devices, TheWordGpuTakesAGpuAndNothingElse) {
  const cl::Device first = all_devices().front();
  for (const char* word : {"gpu", "GPU"}) {
    const auto chosen = choose(word);
    ASSERT_EQ(static_cast<bool>(chosen), is_gpu(first));
    if (chosen) {
      EXPECT_EQ((*chosen)(), first());
    } else {
      EXPECT_EQ(chosen.error().code, Errc::not_found);
      EXPECT_EQ(chosen.error().message,
                "no OpenCL device is a GPU; there are: 0: " + description(first));
    }
  }
}

TEST(Devices, AnUnknownNameIsAnsweredWithWhatThereIs) {
  for (const std::string wanted : {"no such device", "4096"}) {
    const auto chosen = choose(wanted);
    ASSERT_FALSE(chosen);
    EXPECT_EQ(chosen.error().code, Errc::not_found);
    EXPECT_THAT(chosen.error().message, HasSubstr("'" + wanted + "'"));
    const std::vector<cl::Device> devices = all_devices();
    for (std::size_t i = 0; i < devices.size(); ++i) {
      EXPECT_THAT(chosen.error().message,
                  HasSubstr(std::to_string(i) + ": " + description(devices[i])));
    }
    EXPECT_FALSE(Device::open(wanted));
  }
}

TEST(Devices, AnOpenDeviceIsSharedUntilItIsUnusedOrRetired) {
  auto first = *Device::open(""), second = *Device::open("0");
  EXPECT_EQ(first, second);
  EXPECT_GT(first->memory_bytes(), 0U);
  EXPECT_GT(first->largest_buffer_bytes(), 0U);
  EXPECT_EQ(first->name(), description(all_devices().front()));
  first->retire();
  const auto third = *Device::open("");
  EXPECT_NE(third, first) << "though it is still held";
  EXPECT_EQ(third, *Device::open(""));
  const std::weak_ptr<Device> watched = first;
  first.reset();
  second.reset();
  EXPECT_TRUE(watched.expired());
}

/// Waiting, for events that the test completes.
class Waiting : public ::testing::Test {
 protected:
  std::shared_ptr<Device> device_ = *Device::open("");
  cl::UserEvent event_{device_->context()};
};

TEST_F(Waiting, EndsAtOnceWhenAllIsDone) {
  event_.setStatus(CL_COMPLETE);
  EXPECT_TRUE(wait_for(event_, [] { return true; }));
}

TEST_F(Waiting, EndsWhenTheEventCompletesInAnotherThread) {
  std::atomic<int> asked = 0;
  std::thread other([&] {
    while (asked == 0) std::this_thread::yield();
    event_.setStatus(CL_COMPLETE);
  });
  EXPECT_TRUE(wait_for(event_, [&] { return ++asked < 0; }));
  other.join();
}

TEST_F(Waiting, EndsWhenTheHostSaysSoThoughTheEventNeverCompletes) {
  int asked = 0;
  EXPECT_FALSE(wait_for(event_, [&] { return ++asked == 3; }));
  EXPECT_EQ(asked, 3);
  event_.setStatus(CL_COMPLETE);
}

TEST_F(Waiting, ThrowsWhatFailed) {
  event_.setStatus(CL_OUT_OF_RESOURCES);
  try {
    wait_for(event_, [] { return false; });
    ADD_FAILURE() << "nothing was thrown";
  } catch (const cl::Error& failure) {
    EXPECT_EQ(failure.err(), CL_OUT_OF_RESOURCES);
    const Error error = error_of(failure, "testing");
    EXPECT_EQ(error.code, Errc::plugin_failure);
    EXPECT_THAT(error.message, HasSubstr("-5 (out of resources"));
    EXPECT_THAT(error.message, HasSubstr("while testing"));
  }
}

/// A variable of the environment, given another value or none while the test runs.
class Variable {
 public:
  Variable(const char* name, const std::optional<std::string>& value) : name_(name) {
    if (const char* before = std::getenv(name); before != nullptr) before_ = before;
    set(value);
  }
  ~Variable() { set(before_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  void set(const std::optional<std::string>& value) {
    if (value) {
      setenv(name_, value->c_str(), 1);
    } else {
      unsetenv(name_);
    }
  }

  const char* name_;
  std::optional<std::string> before_;
};

/// A folder for programs of this test's own.
class ProgramCache : public ::testing::Test {
 protected:
  ProgramCache() {
    std::string name = (fs::temp_directory_path() / "weft_opencl_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~ProgramCache() override { fs::remove_all(folder_); }

  static std::vector<fs::path> files_in(const fs::path& folder) {
    if (!fs::exists(folder)) return {};
    return {fs::directory_iterator(folder), fs::directory_iterator()};
  }

  static std::string content(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  /// The result of the kernels, which is compared bit by bit: blurred noise.
  std::vector<float> blurred() {
    KernelRunner runner(device_, compiled(device_->context(), device_->handle()));
    const auto noise = reference::floats_of(white_noise({32, 8}, 71));
    const cl::Buffer to = runner.upload(noise);
    runner.over_pixels("blur_rows", 32, 8, runner.upload(noise), cl_ulong{0}, 32, 8,
                       runner.upload(std::vector<float>{0.5F, 0.2F, 0.05F}), 0, 2, to);
    return runner.download<float>(to, noise.size());
  }

  std::shared_ptr<Device> device_ = *Device::open("");
  fs::path folder_;
};

TEST_F(ProgramCache, KeepsTheCompiledKernelsAndTakesThemFromThere) {
  const Variable cache("XDG_CACHE_HOME", folder_.string());
  const std::vector<float> expected = blurred();
  const std::vector<fs::path> files = files_in(folder_ / "weft" / "opencl");
  ASSERT_EQ(files.size(), 1U) << "one program, and nothing half written";
  const std::string program = content(files.front());
  EXPECT_GT(program.size(), 1000U);
  const auto written = fs::last_write_time(files.front());
  EXPECT_EQ(blurred(), expected);
  EXPECT_EQ(files_in(folder_ / "weft" / "opencl"), files);
  EXPECT_EQ(fs::last_write_time(files.front()), written) << "taken from the cache";
}

TEST_F(ProgramCache, IsStoredInTheHomeFolderByDefault) {
  const std::vector<float> expected = blurred();
  const Variable home("HOME", folder_.string());
  for (const std::optional<std::string>& none :
       {std::optional<std::string>(), std::optional<std::string>("not/absolute")}) {
    const Variable cache("XDG_CACHE_HOME", none);
    EXPECT_EQ(blurred(), expected);
    EXPECT_EQ(files_in(folder_ / ".cache" / "weft" / "opencl").size(), 1U);
    fs::remove_all(folder_ / ".cache");
  }
}

TEST_F(ProgramCache, MayBeMissingOrUnwritable) {
  std::ofstream(folder_ / "a file") << "no folder";
  const std::vector<float> expected = blurred();
  const Variable home("HOME", std::nullopt);
  for (const std::optional<std::string>& place :
       {std::optional<std::string>(), std::optional<std::string>(folder_ / "a file")}) {
    const Variable cache("XDG_CACHE_HOME", place);
    EXPECT_EQ(blurred(), expected);
  }
}

TEST_F(ProgramCache, ReplacesAFileThatIsNoProgram) {
  const Variable cache("XDG_CACHE_HOME", folder_.string());
  const std::vector<float> expected = blurred();
  const fs::path file = files_in(folder_ / "weft" / "opencl").at(0);
  const std::string program = content(file);
  Rng rng(72);
  std::string noise;
  for (std::size_t i = 0; i < program.size(); ++i)
    noise.push_back(static_cast<char>(rng.below(256)));
  std::string flipped = program;
  flipped[flipped.size() / 2] ^= 1;
  for (const std::string& damaged :
       {std::string(), std::string("x"), noise, flipped, program.substr(0, 4000),
        program.substr(0, program.size() / 2), program.substr(0, program.size() - 1)}) {
    std::ofstream(file, std::ios::binary | std::ios::trunc) << damaged;
    EXPECT_EQ(blurred(), expected);
    EXPECT_GT(content(file).size(), 1000U) << "stored again";
    EXPECT_NE(content(file), damaged);
  }
}

}  // namespace
}  // namespace weft::sift_gpu
