# SPDX-License-Identifier: Apache-2.0
#
# weft_enable_warnings(target): the warnings under which all code of this tree compiles, for whatever
# links the INTERFACE library `target`. With WEFT_WERROR (ON in the presets) each is an error.

function(weft_enable_warnings target)
  target_compile_options(${target} INTERFACE -Wall -Wextra -Wpedantic -Wshadow)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # False alarms inside std::string of GCC 12, its bug 105651.
    target_compile_options(${target} INTERFACE -Wno-restrict)
  endif()
  if(WEFT_SANITIZE AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC's flow analysis sees the instrumentation and reports initialised variables.
    target_compile_options(${target} INTERFACE -Wno-maybe-uninitialized)
  endif()
  if(WEFT_WERROR)
    target_compile_options(${target} INTERFACE -Werror)
  endif()
endfunction()
