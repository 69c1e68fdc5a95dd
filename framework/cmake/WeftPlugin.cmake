# SPDX-License-Identifier: Apache-2.0
#
# weft_add_plugin(role/name SOURCES a.cpp ... [LINK library ...]
#                 [TESTS a_test.cpp ...] [LONG_TESTS b_test.cpp ...] [FOLDER folder]
#                 [CONTRACT argument ...] [BROKEN])
#
# Builds <role>_<name>.so, which exports nothing but `weft_library`, and has weft::describe write the
# manifest <role>_<name>.plugin.yaml beside it; both in FOLDER where it is given, else in this tree's
# plugin folder or another tree's build folder; `cmake --install` puts both into lib/weft/plugins.
# role/name is the id of its first component. The same function serves this tree and, after find_package(weft), any
# other. Tests are built where GTest and weft::testing exist; they are linked with the plugin's
# objects, so that they can test its parts as well as call it through the contract.
#
# Each component of the library is held to the contract, by the test <role>_<name>_contract: `weft
# plugins check --brief`. CONTRACT gives what it needs for that, which is written beside the manifest,
# as <role>_<name>.check, for whoever calls that program:
#   "{texture: FILE, width_m: 0.2}"   parameters, such as those that are required
#   deviates "with 0 matches"         a check that fails, as the component's page says
#   skipped "a camera is needed"      why it cannot be checked; told, and no success
#   role/name                         what follows is about this component, not about the first one
# BROKEN is a plugin for tests of the host, which breaks the contract on purpose or when it is told
# to: it is not held to it.
#
# With sanitizers the cache variable WEFT_PLAIN_PLUGINS may name the plugin folder of a build without
# them, from which plugins are taken as they are, but for those in WEFT_CHECKED_PLUGINS, a list of
# folders such as "filters/aem;common/images". With ThreadSanitizer all that start threads are in it.

set(WEFT_PLUGIN_CMAKE_DIR ${CMAKE_CURRENT_LIST_DIR})

function(weft_add_plugin id)
  cmake_parse_arguments(PARSE_ARGV 1 arg "BROKEN" "FOLDER"
    "SOURCES;LINK;TESTS;LONG_TESTS;CONTRACT")
  if(NOT id MATCHES "^[a-z][a-z0-9_]*/([a-z][a-z0-9_]*\\.)?[a-z][a-z0-9_]*$")
    message(FATAL_ERROR "weft_add_plugin: '${id}' is not of the form role/name or role/vendor.name")
  endif()
  if(NOT arg_SOURCES)
    message(FATAL_ERROR "weft_add_plugin(${id}): SOURCES is empty")
  endif()
  string(REPLACE "/" "_" name ${id})
  if(arg_FOLDER)
    set(folder ${arg_FOLDER})
  elseif(PROJECT_NAME STREQUAL "weft")
    set(folder ${PROJECT_BINARY_DIR}/lib/weft/plugins)
  else()
    set(folder ${PROJECT_BINARY_DIR})
  endif()

  # One compilation serves the library and its tests.
  add_library(${name}_objects OBJECT ${arg_SOURCES})
  set_target_properties(${name}_objects PROPERTIES
    POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  target_link_libraries(${name}_objects PUBLIC weft::sdk ${arg_LINK})

  add_library(${name} MODULE)
  target_link_libraries(${name} PRIVATE ${name}_objects)
  set_target_properties(${name} PROPERTIES PREFIX "" LIBRARY_OUTPUT_DIRECTORY ${folder}
    LINK_DEPENDS ${WEFT_PLUGIN_CMAKE_DIR}/weft_plugin.map)
  target_link_options(${name} PRIVATE -Wl,--build-id=sha1
    -Wl,--version-script=${WEFT_PLUGIN_CMAKE_DIR}/weft_plugin.map)
  # What is missing is said now, not when it is loaded. What sanitizers need comes with the program.
  get_target_property(sdk_options weft::sdk INTERFACE_LINK_OPTIONS)
  if(NOT "${sdk_options} ${CMAKE_CXX_FLAGS}" MATCHES "-fsanitize")
    target_link_options(${name} PRIVATE -Wl,-z,defs)
  endif()

  set(manifest ${folder}/${name}.plugin.yaml)
  weft_is_checked(is_checked ${CMAKE_CURRENT_SOURCE_DIR})
  if(NOT is_checked AND NOT arg_FOLDER)
    set_target_properties(${name}_objects ${name} PROPERTIES EXCLUDE_FROM_ALL ON)
    set(plain ${WEFT_PLAIN_PLUGINS}/${name}.so ${WEFT_PLAIN_PLUGINS}/${name}.plugin.yaml)
    add_custom_command(OUTPUT ${manifest}
      COMMAND ${CMAKE_COMMAND} -E copy ${plain} ${folder}
      DEPENDS ${plain}
      COMMENT "Taking ${id} as it is" VERBATIM)
  elseif(CMAKE_CROSSCOMPILING AND NOT CMAKE_CROSSCOMPILING_EMULATOR)
    message(STATUS "Not described, as it cannot run here: ${id}; run `weft plugins describe ${name}.so` where "
      "it is installed, or set CMAKE_CROSSCOMPILING_EMULATOR")
    set(manifest "")
  else()
    add_custom_command(OUTPUT ${manifest}
      COMMAND ${CMAKE_CROSSCOMPILING_EMULATOR} $<TARGET_FILE:weft::describe>
        $<TARGET_FILE:${name}> ${manifest} ${id}
      DEPENDS ${name} weft::describe
      COMMENT "Describing ${id}" VERBATIM)
  endif()
  if(TARGET weft_options)
    target_link_libraries(${name}_objects PRIVATE weft_options)
    target_link_libraries(${name} PRIVATE weft_options)
  endif()
  add_custom_target(${name}_manifest ALL DEPENDS ${manifest})
  if(TARGET weft_plugins AND NOT arg_FOLDER)
    add_dependencies(weft_plugins ${name}_manifest)
  endif()

  if(NOT arg_FOLDER AND NOT arg_BROKEN)
    install(TARGETS ${name} LIBRARY DESTINATION lib/weft/plugins COMPONENT plugins)
    install(FILES ${manifest} DESTINATION lib/weft/plugins COMPONENT plugins)
  endif()

  if(TARGET weft::testing AND TARGET GTest::gtest_main AND is_checked)
    weft_add_plugin_test(${name} ${name}_test quick "${arg_TESTS}")
    weft_add_plugin_test(${name} ${name}_long_test long "${arg_LONG_TESTS}")
  endif()
  # Sanitizers see the plugin's own tests.
  if(NOT arg_BROKEN AND NOT WEFT_SANITIZE AND NOT CMAKE_CROSSCOMPILING)
    weft_add_contract_test(${name}_contract ${folder}/${name} "${arg_CONTRACT}")
  endif()
endfunction()

# weft_check_plugin(role/name PIPELINE pipeline.yaml PAGE README.md)
#
# For a tree of its own, behind weft_add_plugin: the target `check` builds the plugin and runs all
# tests of the tree. It adds two: <role>_<name>_pipeline runs PIPELINE with the plugin, and
# <role>_<name>_page compares the tables of parameters in PAGE with what the plugin declares; the
# target of that name writes them anew.
function(weft_check_plugin id)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "PIPELINE;PAGE" "")
  string(REPLACE "/" "_" name ${id})
  weft_plugin_path(plugin_path)
  if(arg_PIPELINE)
    add_test(NAME ${name}_pipeline
      COMMAND sh -c "rm -rf \"$2\" && exec \"$0\" run \"$1\" --out \"$2\"" $<TARGET_FILE:weft::weft>
        ${CMAKE_CURRENT_SOURCE_DIR}/${arg_PIPELINE} ${CMAKE_CURRENT_BINARY_DIR}/${name}_run)
    set_tests_properties(${name}_pipeline PROPERTIES LABELS quick
      ENVIRONMENT "WEFT_PLUGIN_PATH=${plugin_path}")
  endif()

  find_package(Python3 COMPONENTS Interpreter)
  if(arg_PAGE AND Python3_Interpreter_FOUND)
    set(page ${CMAKE_CURRENT_SOURCE_DIR}/${arg_PAGE})
    add_test(NAME ${name}_page
      COMMAND ${Python3_EXECUTABLE} ${weft_PARAMETER_TABLES} $<TARGET_FILE:weft::weft> ${page})
    set_tests_properties(${name}_page PROPERTIES LABELS quick
      ENVIRONMENT "WEFT_PLUGIN_PATH=${plugin_path}")
    add_custom_target(${name}_page
      COMMAND ${CMAKE_COMMAND} -E env "WEFT_PLUGIN_PATH=${plugin_path}" ${Python3_EXECUTABLE}
        ${weft_PARAMETER_TABLES} --write $<TARGET_FILE:weft::weft> ${page}
      DEPENDS ${name}_manifest VERBATIM)
  elseif(arg_PAGE)
    message(STATUS "Not tested: ${arg_PAGE}, for which Python 3 is missing")
  endif()

  if(NOT TARGET check)
    add_custom_target(check COMMAND ${CMAKE_CTEST_COMMAND} --output-on-failure --no-tests=error
      WORKING_DIRECTORY ${CMAKE_BINARY_DIR} USES_TERMINAL VERBATIM)
  endif()
  add_dependencies(check ${name}_manifest)
  if(TARGET ${name}_test)
    add_dependencies(check ${name}_test)
  endif()
endfunction()

set(WEFT_CHECKED_PLUGINS "" CACHE STRING "With WEFT_PLAIN_PLUGINS: folders below plugins/ that are compiled")

# weft_is_checked(RESULT FOLDER): false where what is in the folder is taken from WEFT_PLAIN_PLUGINS.
function(weft_is_checked result folder)
  set(${result} TRUE PARENT_SCOPE)
  file(RELATIVE_PATH id ${PROJECT_SOURCE_DIR}/plugins ${folder})
  if(NOT WEFT_PLAIN_PLUGINS OR id MATCHES "^\\.\\./" OR id IN_LIST WEFT_CHECKED_PLUGINS)
    return()
  endif()
  if(WEFT_SANITIZE MATCHES "thread")
    set(thread_headers "<(atomic|condition_variable|future|mutex|thread|CL/opencl[.]hpp)>|/workers/")
    file(GLOB sources ${folder}/*.cpp ${folder}/*.hpp)
    foreach(source IN LISTS sources)
      file(STRINGS ${source} lines REGEX "^#include .*(${thread_headers})")
      if(lines)
        return()
      endif()
    endforeach()
  endif()
  set(${result} FALSE PARENT_SCOPE)
endfunction()

# weft_plugin_path(RESULT): where tests find plugins, as in WEFT_PLUGIN_PATH.
function(weft_plugin_path result)
  if(PROJECT_NAME STREQUAL "weft")
    set(${result} ${PROJECT_BINARY_DIR}/lib/weft/plugins PARENT_SCOPE)
  else()
    set(${result} "${PROJECT_BINARY_DIR}:${weft_PLUGIN_FOLDER}" PARENT_SCOPE)
  endif()
endfunction()

# A component that lacks a device is skipped, with the reason.
function(weft_add_contract_test test plugin arguments)
  string(REGEX REPLACE "[ \n]+" " " lines "${arguments}")
  list(JOIN lines "\n" lines)
  if(PROJECT_NAME STREQUAL "weft")
    string(PREPEND lines "geometry\n")  # of the first component; others of a library say it
  endif()
  file(GENERATE OUTPUT ${plugin}.check CONTENT "${lines}\n")
  if(TARGET weft::weft)
    set(program weft::weft)
  elseif(PROJECT_NAME STREQUAL "weft")
    set(program weft)  # which comes later
  else()
    return()
  endif()
  weft_plugin_path(plugin_path)
  add_test(NAME ${test} COMMAND ${program} plugins check --brief ${plugin}.plugin.yaml)
  set_tests_properties(${test} PROPERTIES LABELS quick
    SKIP_REGULAR_EXPRESSION "checked: 0 fail, [1-9]"
    ENVIRONMENT "WEFT_PLUGIN_PATH=${plugin_path}")
endfunction()

function(weft_add_plugin_test name test label sources)
  if(NOT sources)
    return()
  endif()
  weft_add_test(${test} ${label} SOURCES ${sources} LINK ${name}_objects)
  add_dependencies(${test} ${name}_manifest)
endfunction()

# weft_add_test(name quick|long SOURCES ... [LINK ...]): a GoogleTest program that finds the plugins.
# Long ones are built when they are run: by the test build_long_tests, or the target weft_long_tests.
function(weft_add_test name label)
  cmake_parse_arguments(PARSE_ARGV 2 arg "" "" "SOURCES;LINK")
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE weft::testing GTest::gmock GTest::gtest_main ${arg_LINK})
  if(TARGET weft_options)
    target_link_libraries(${name} PRIVATE weft_options weft_test_options)
  endif()
  target_include_directories(${name} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
  # Tests spend their compile time in headers: the files of a batch share them, and all tests of this
  # tree share the common ones, read once.
  if(TARGET weft_test_headers)
    target_precompile_headers(${name} REUSE_FROM weft_test_headers)
  endif()
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests
    UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 16)
  weft_plugin_path(plugin_path)
  add_test(NAME ${name} COMMAND ${name})
  set_tests_properties(${name} PROPERTIES LABELS ${label}
    ENVIRONMENT "WEFT_PLUGIN_PATH=${plugin_path}")
  if(label STREQUAL "long")
    weft_build_with_long_tests(${name})
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL ON)
    set_tests_properties(${name} PROPERTIES FIXTURES_REQUIRED long_tests TIMEOUT 3600)
  endif()
endfunction()

function(weft_build_with_long_tests target)
  if(NOT TARGET weft_long_tests)
    add_custom_target(weft_long_tests)
    add_test(NAME build_long_tests
      COMMAND ${CMAKE_COMMAND} --build ${PROJECT_BINARY_DIR} --target weft_long_tests)
    set_tests_properties(build_long_tests PROPERTIES LABELS long FIXTURES_SETUP long_tests
      TIMEOUT 3600)
  endif()
  add_dependencies(weft_long_tests ${target})
endfunction()
