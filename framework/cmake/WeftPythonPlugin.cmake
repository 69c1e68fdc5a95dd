# SPDX-License-Identifier: Apache-2.0
#
# weft_add_python_plugin(role/name MODULES a.py ... [TESTS a_test.py ...] [FOLDER folder]
#                        [CONTRACT argument ...] [BROKEN])
#
# Builds <role>_<name>.so of components in Python, as weft_add_plugin does of those in C++. The modules
# travel in the library: it is built anew when one of them changes, and needs none of them to run. The
# first component is role/name; all classes with an id in the modules are components. TESTS are programs in
# Python, run by the test <role>_<name>_test, which find the modules and the package weft.

set(WEFT_PYTHON_CMAKE_DIR ${CMAKE_CURRENT_LIST_DIR})

function(weft_add_python_plugin id)
  cmake_parse_arguments(PARSE_ARGV 1 arg "BROKEN" "FOLDER" "MODULES;TESTS;CONTRACT")
  if(NOT TARGET weft::python)
    message(FATAL_ERROR "weft_add_python_plugin(${id}): this Weft was built without components in Python, "
      "for which Python's headers and NumPy were missing (Debian: python3-dev, python3-numpy)")
  endif()
  if(NOT arg_MODULES)
    message(FATAL_ERROR "weft_add_python_plugin(${id}): MODULES is empty")
  endif()
  # NumPy is that of Weft's own Python; another one has none, it may be.
  if(NOT Python3_EXECUTABLE AND NOT Python3_ROOT_DIR AND EXISTS "${weft_PYTHON_EXECUTABLE}")
    set(Python3_EXECUTABLE ${weft_PYTHON_EXECUTABLE})
  endif()
  find_package(Python3 REQUIRED COMPONENTS Interpreter Development.Embed)
  string(REPLACE "/" "_" name ${id})
  set(modules "")
  set(folders ${weft_PYTHON_FOLDER})
  foreach(module IN LISTS arg_MODULES)
    get_filename_component(module ${module} ABSOLUTE)
    get_filename_component(folder ${module} DIRECTORY)
    list(APPEND modules ${module})
    list(APPEND folders ${folder})
  endforeach()
  list(REMOVE_DUPLICATES folders)

  set(table ${CMAKE_CURRENT_BINARY_DIR}/${name}_table.cpp)
  file(GLOB package CONFIGURE_DEPENDS ${weft_PYTHON_FOLDER}/*.py ${weft_PYTHON_FOLDER}/weft/*.py)
  add_custom_command(OUTPUT ${table}
    COMMAND ${Python3_EXECUTABLE} ${weft_PYTHON_FOLDER}/embed.py ${id} ${table} ${modules}
    DEPENDS ${modules} ${package}
    COMMENT "Embedding ${id}" VERBATIM)
  set(more "")
  if(arg_FOLDER)
    list(APPEND more FOLDER ${arg_FOLDER})
  endif()
  if(arg_BROKEN)
    list(APPEND more BROKEN)
  endif()
  weft_add_plugin(${id} SOURCES ${table} LINK weft::python Python3::Python ${more}
    CONTRACT ${arg_CONTRACT})

  list(JOIN folders ":" path)
  foreach(test IN LISTS arg_TESTS)
    get_filename_component(test ${test} ABSOLUTE)
    get_filename_component(test_name ${test} NAME_WE)
    add_test(NAME ${name}_${test_name} COMMAND ${Python3_EXECUTABLE} -B ${test})
    set_tests_properties(${name}_${test_name} PROPERTIES LABELS quick ENVIRONMENT "PYTHONPATH=${path}")
  endforeach()
endfunction()
