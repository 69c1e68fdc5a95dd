# SPDX-License-Identifier: Apache-2.0
# Part of `cmake --install`: ends it where a file of its component is not built.
if(CMAKE_INSTALL_COMPONENT)
  set(lists ${weft_build_folder}/installed/${CMAKE_INSTALL_COMPONENT}.txt)
else()
  file(GLOB lists ${weft_build_folder}/installed/*.txt)
endif()
foreach(list IN LISTS lists)
  set(files "")
  if(EXISTS ${list})
    file(STRINGS ${list} files)
  endif()
  foreach(file IN LISTS files)
    if(NOT EXISTS ${file})
      message(FATAL_ERROR "${file} is not built. Build first:\n"
        "  cmake --build ${weft_build_folder} --target weft_installed")
    endif()
  endforeach()
endforeach()
