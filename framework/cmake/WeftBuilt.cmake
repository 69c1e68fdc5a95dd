# SPDX-License-Identifier: Apache-2.0
#
# The target weft_installed builds what `cmake --install` copies. An installation of a build that
# lacks some of it ends before the first file, with the command that builds it: CheckBuilt.cmake.

# To be called before the folders that install something.
function(weft_check_built_before_installing)
  add_custom_target(weft_installed)
  install(CODE "set(weft_build_folder \"${PROJECT_BINARY_DIR}\")
include(\"${PROJECT_SOURCE_DIR}/framework/cmake/CheckBuilt.cmake\")" ALL_COMPONENTS)
endfunction()

# weft_built_before_installing(component target...): the component `plugins` has all plugins too; a
# target that does not exist is ignored.
function(weft_built_before_installing component)
  set(files "")
  foreach(target IN LISTS ARGN)
    if(TARGET ${target})
      add_dependencies(weft_installed ${target})
      string(APPEND files "$<TARGET_FILE:${target}>\n")
    endif()
  endforeach()
  get_target_property(manifests weft_plugins MANUALLY_ADDED_DEPENDENCIES)
  if(component STREQUAL "plugins" AND manifests)
    add_dependencies(weft_installed weft_plugins)
    foreach(manifest IN LISTS manifests)
      string(REGEX REPLACE "_manifest$" ".so" library ${manifest})
      string(APPEND files "${PROJECT_BINARY_DIR}/lib/weft/plugins/${library}\n")
    endforeach()
  endif()
  file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/installed/${component}.txt CONTENT "${files}")
endfunction()
