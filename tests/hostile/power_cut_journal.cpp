// SPDX-License-Identifier: Apache-2.0
// This library is loaded before a program (LD_PRELOAD). It records which parts of a folder have
// reached the disk, and stops the program at a chosen moment. From these records power_cuts.py
// makes what a power cut leaves.
//
// Nothing is written to the disk here. A call of fsync() keeps a copy of the file, or a list of the
// entries of the folder. Every call that changes the folder, and every fsync(), is a moment. At the
// chosen one all processes halt before they change the folder again.
#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <ftw.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

/// A file that the processes share, made by power_cuts.py.
struct Shared {
  std::atomic<std::int64_t> is_busy, moments, last_moment, is_cut;
};

/// A function of the C library by its name.
template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

struct Journal {
  std::string root, store;
  Shared* shared = nullptr;

  Journal() {
    const char* folder = std::getenv("POWER_CUT");
    const char* watched = std::getenv("POWER_CUT_ROOT");
    if (folder == nullptr || watched == nullptr) return;
    root = watched;
    store = std::string(folder) + "/store/";
    const int file = next<int(const char*, int, ...)>("open")(
        (std::string(folder) + "/state").c_str(), O_RDWR | O_CLOEXEC);
    void* memory = mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    if (memory == MAP_FAILED) std::abort();
    shared = static_cast<Shared*>(memory);
  }
};

const Journal& journal() {
  static const Journal made;
  return made;
}

bool is_watched(const char* path) {
  if (journal().shared == nullptr || path == nullptr) return false;
  const std::string& root = journal().root;
  char here[PATH_MAX];
  std::string whole = path;
  if (*path != '/' && getcwd(here, sizeof(here)) != nullptr) whole = std::string(here) + "/" + path;
  return whole == root || whole.starts_with(root + "/");
}

bool is_watched(int file) {
  if (journal().shared == nullptr) return false;
  char path[PATH_MAX];
  const std::string link = "/proc/self/fd/" + std::to_string(file);
  const ssize_t length = readlink(link.c_str(), path, sizeof(path) - 1);
  if (length <= 0) return false;
  path[length] = '\0';
  return *path == '/' && is_watched(path);
}

/// While it lives, no other process changes the folder. The cut ends the life of none.
class Moment {
 public:
  explicit Moment(bool is_watched) : is_watched_(is_watched) {
    if (!is_watched_) return;
    Shared& shared = *journal().shared;
    std::int64_t idle = 0;
    while (!shared.is_busy.compare_exchange_weak(idle, 1)) {
      idle = 0;
      usleep(100);
    }
    if (++shared.moments >= shared.last_moment) {
      shared.is_cut = 1;
      for (;;) pause();
    }
  }
  ~Moment() {
    if (is_watched_) journal().shared->is_busy = 0;
  }
  Moment(const Moment&) = delete;
  Moment& operator=(const Moment&) = delete;

 private:
  bool is_watched_;
};

/// Keeps the file and its number, so that no other file gets it.
void keep(const std::string& path, ino_t number) {
  linkat(AT_FDCWD, path.c_str(), AT_FDCWD, (journal().store + std::to_string(number)).c_str(),
         AT_SYMLINK_FOLLOW);
}

void write_down(ino_t number, const char* kind, const std::string& content) {
  const std::string file = journal().store + std::to_string(number) + kind;
  std::FILE* stream = std::fopen((file + ".new").c_str(), "wb");
  if (stream == nullptr) std::abort();
  std::fwrite(content.data(), 1, content.size(), stream);
  std::fclose(stream);
  next<int(const char*, const char*)>("rename")((file + ".new").c_str(), file.c_str());
}

void note_file(int file, const struct stat& status) {
  const std::string path = "/proc/self/fd/" + std::to_string(file);
  keep(path, status.st_ino);
  const int reading = next<int(const char*, int, ...)>("open")(path.c_str(), O_RDONLY | O_CLOEXEC);
  std::string content;
  char piece[65536];
  for (ssize_t got = 0; (got = read(reading, piece, sizeof(piece))) > 0;) {
    content.append(piece, static_cast<std::size_t>(got));
  }
  close(reading);
  write_down(status.st_ino, ".synced", content);
}

/// Type, number and name of each entry, and where a link leads to; each ends with a NUL.
void note_folder(const std::string& path, ino_t number) {
  DIR* folder = opendir(path.c_str());
  if (folder == nullptr) return;
  std::string list;
  while (const dirent* entry = readdir(folder)) {
    const std::string name = entry->d_name, at = path + "/" + name;
    struct stat status {};
    if (name == "." || name == ".." || lstat(at.c_str(), &status) != 0) continue;
    const char* type = S_ISDIR(status.st_mode) ? "d" : S_ISLNK(status.st_mode) ? "l" : "f";
    char target[PATH_MAX] = {};
    if (*type == 'l') static_cast<void>(!readlink(at.c_str(), target, sizeof(target) - 1));
    if (*type == 'f') keep(at, status.st_ino);
    for (const std::string& part :
         {std::string(type), std::to_string(status.st_ino), name, std::string(target)}) {
      list += part + '\0';
    }
  }
  closedir(folder);
  write_down(number, ".folder", list);
}

void note(int file) {
  struct stat status {};
  if (fstat(file, &status) != 0) return;
  if (S_ISREG(status.st_mode)) note_file(file, status);
  if (S_ISDIR(status.st_mode)) note_folder("/proc/self/fd/" + std::to_string(file), status.st_ino);
}

int note_entry(const char* path, const struct stat* status, int type, FTW*) {
  if (type == FTW_D) note_folder(path, status->st_ino);
  if (type != FTW_F || !S_ISREG(status->st_mode)) return 0;
  const int file = next<int(const char*, int, ...)>("open")(path, O_RDONLY | O_CLOEXEC);
  if (file >= 0) note_file(file, *status);
  if (file >= 0) close(file);
  return 0;
}

int synced(int file, const char* name) {
  if (!is_watched(file)) return next<int(int)>(name)(file);
  const Moment moment(true);
  note(file);
  return 0;
}

mode_t mode_of(int flags, std::va_list list) {
  return (flags & O_CREAT) != 0 ? va_arg(list, mode_t) : 0;
}

}  // namespace

extern "C" {

int fsync(int file) { return synced(file, "fsync"); }
int fdatasync(int file) { return synced(file, "fdatasync"); }

int syncfs(int file) {
  if (!is_watched(file)) return next<int(int)>("syncfs")(file);
  const Moment moment(true);
  nftw(journal().root.c_str(), note_entry, 16, FTW_PHYS);
  return 0;
}

int rename(const char* from, const char* to) {
  const Moment moment(is_watched(to));
  return next<int(const char*, const char*)>("rename")(from, to);
}

int mkdir(const char* path, mode_t mode) {
  const Moment moment(is_watched(path));
  return next<int(const char*, mode_t)>("mkdir")(path, mode);
}

int unlink(const char* path) {
  const Moment moment(is_watched(path));
  return next<int(const char*)>("unlink")(path);
}

int remove(const char* path) {
  const Moment moment(is_watched(path));
  return next<int(const char*)>("remove")(path);
}

int symlink(const char* target, const char* path) {
  const Moment moment(is_watched(path));
  return next<int(const char*, const char*)>("symlink")(target, path);
}

int ftruncate(int file, off_t size) {
  const Moment moment(is_watched(file));
  return next<int(int, off_t)>("ftruncate")(file, size);
}

ssize_t write(int file, const void* bytes, size_t count) {
  const Moment moment(is_watched(file));
  return next<ssize_t(int, const void*, size_t)>("write")(file, bytes, count);
}

int open(const char* path, int flags, ...) {
  std::va_list list;
  va_start(list, flags);
  const mode_t mode = mode_of(flags, list);
  va_end(list);
  const Moment moment((flags & O_CREAT) != 0 && is_watched(path));
  return next<int(const char*, int, ...)>("open")(path, flags, mode);
}

}  // extern "C"
