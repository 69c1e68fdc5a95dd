# SPDX-License-Identifier: Apache-2.0
#
# weft_enable_sanitizers(target): compiles and links whatever links the INTERFACE library `target`
# with the sanitizers of the cache variable WEFT_SANITIZE, a comma-separated list of `address`,
# `leak`, `undefined`, `thread`, and with Clang `fuzzer`, which counts branches for libFuzzer. An empty
# list does nothing. Undefined behaviour ends the program.

function(weft_enable_sanitizers target)
  string(REPLACE "," ";" sanitizers "${WEFT_SANITIZE}")
  list(REMOVE_DUPLICATES sanitizers)
  if(NOT sanitizers)
    return()
  endif()

  foreach(sanitizer IN LISTS sanitizers)
    if(NOT sanitizer MATCHES "^(address|leak|undefined|thread|fuzzer)$")
      message(FATAL_ERROR "WEFT_SANITIZE: '${sanitizer}' is not one of address, leak, undefined, "
        "thread, fuzzer; separate several by commas, without spaces")
    endif()
  endforeach()
  if("thread" IN_LIST sanitizers AND ("address" IN_LIST sanitizers OR "leak" IN_LIST sanitizers))
    message(FATAL_ERROR "WEFT_SANITIZE: 'thread' cannot be combined with 'address' or 'leak'; "
      "use two build folders (presets asan and tsan)")
  endif()
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES "^(GNU|Clang)$")
    message(FATAL_ERROR "WEFT_SANITIZE needs GCC or Clang, not ${CMAKE_CXX_COMPILER_ID}")
  endif()

  if("fuzzer" IN_LIST sanitizers)
    if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
      message(FATAL_ERROR "WEFT_SANITIZE: 'fuzzer' needs Clang, not ${CMAKE_CXX_COMPILER_ID} (preset fuzz)")
    endif()
    # What is fuzzed alone is linked with a main() of libFuzzer, in tests/hostile/fuzz.
    list(REMOVE_ITEM sanitizers fuzzer)
    list(APPEND sanitizers fuzzer-no-link)
  endif()
  list(JOIN sanitizers "," joined)
  set(flags -fsanitize=${joined})
  if("undefined" IN_LIST sanitizers)
    list(APPEND flags -fno-sanitize-recover=undefined)
    # A third of the compile time, for pointers that `address` or the processor catches when used.
    if("address" IN_LIST sanitizers)
      list(APPEND flags -fno-sanitize=null,alignment,object-size)
    endif()
  endif()
  target_compile_options(${target} INTERFACE ${flags} -fno-omit-frame-pointer)
  target_link_options(${target} INTERFACE ${flags})
endfunction()
