# SPDX-License-Identifier: Apache-2.0
# Libraries that a program of Weft contains. A shared library of the program would answer the calls of
# its plugins too, also of those that bring another version of it. Shared objects of Weft, such as the
# module for Python, are loaded with a scope of their own, and link the shared libraries.

# weft_contain(<variable> <target> <archive>...): what to link for <target>, where programs of this build
# take the archives. Those who link the installed Weft, and systems without the archives, take <target>.
function(weft_contain variable target)
  foreach(name IN LISTS ARGN)
    string(MAKE_C_IDENTIFIER "WEFT_ARCHIVE_${name}" archive)
    find_library(${archive} lib${name}.a)
    mark_as_advanced(${archive})
    list(APPEND archives ${${archive}})
  endforeach()
  if(archives MATCHES "NOTFOUND")
    message(STATUS "Shared with plugins: ${target}, since there is no static library of it")
    set(${variable} ${target} PARENT_SCOPE)
    return()
  endif()
  set(is_program $<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>)
  set(linked $<INSTALL_INTERFACE:${target}> $<BUILD_INTERFACE:$<$<NOT:${is_program}>:${target}>>)
  foreach(archive IN LISTS archives)
    list(APPEND linked $<BUILD_INTERFACE:$<${is_program}:${archive}>>)
  endforeach()
  set(${variable} ${linked} PARENT_SCOPE)
endfunction()

weft_contain(WEFT_BOOST_FILESYSTEM Boost::filesystem boost_filesystem)
weft_contain(WEFT_YAML_CPP yaml-cpp yaml-cpp)
weft_contain(WEFT_XXHASH PkgConfig::xxhash xxhash)
weft_contain(WEFT_MINIZIP PkgConfig::minizip minizip z)
weft_contain(WEFT_SQLITE SQLite::SQLite3 sqlite3)
weft_contain(WEFT_PNG PNG::PNG png z)
