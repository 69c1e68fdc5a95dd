// SPDX-License-Identifier: Apache-2.0
#include "cli/run/browser.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>

#include "process/child.hpp"

namespace weft::cli {
namespace {

/// The desktop's program runs on after this one: its output is discarded, and it runs in its own
/// process group so that Ctrl-C does not reach it.
void start_desktop(const std::string& address) {
  const auto started =
      process::Child::start(process::Program{.words = {"xdg-open", address}, .own_group = true});
  if (started) (*started)->leave();
}

}  // namespace

void Browser::open(const std::string& page, const std::string& token) {
  if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return;
  const std::string address = token.empty() ? page : write_private(page + "?token=" + token);
  if (!address.empty()) start_desktop(address);
}

std::string Browser::write_private(const std::string& page) {
  auto folder = ScratchFolder::make("weft-live");
  if (!folder) return "";
  folder_.emplace(*std::move(folder));
  const std::string file = folder_->path() + "/page.html";
  // Neither the address nor the token has a character that HTML would read in another way.
  const std::string text =
      "<!DOCTYPE html>\n<meta charset=\"utf-8\">\n<meta name=\"referrer\" "
      "content=\"no-referrer\">\n"
      "<meta http-equiv=\"refresh\" content=\"0; url=" +
      page + "\">\n<title>Weft live</title>\n<a href=\"" + page + "\">Weft live</a>\n";
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (descriptor < 0) return "";
  const ssize_t written = write(descriptor, text.data(), text.size());
  const bool is_whole = close(descriptor) == 0 && written == static_cast<ssize_t>(text.size());
  return is_whole ? "file://" + file : "";
}

}  // namespace weft::cli
