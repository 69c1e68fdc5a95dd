# SPDX-License-Identifier: Apache-2.0
#
# What `cmake --install` puts where, and the Debian packages of it (`cpack`): weft, weft-plugins,
# weft-dev and python3-weft. The program finds plugins, worker, report and scaffold beside itself, so that a folder of it
# can be moved. weft_add_plugin installs its plugin by itself. The build tree is a package too.

include(CMakePackageConfigHelpers)
set(package lib/cmake/weft)

install(TARGETS weft weft_worker EXPORT weftTargets RUNTIME DESTINATION bin COMPONENT runtime)
# With the plugins, as these have OpenCV already.
if(TARGET weft_calibrate)
  install(TARGETS weft_calibrate RUNTIME DESTINATION bin COMPONENT plugins)
endif()
if(TARGET weft_count_allocations)
  install(TARGETS weft_count_allocations LIBRARY DESTINATION lib/weft COMPONENT runtime)
endif()
install(DIRECTORY ${PROJECT_BINARY_DIR}/share/weft/report DESTINATION share/weft COMPONENT runtime)
install(DIRECTORY pipelines DESTINATION share/weft COMPONENT runtime)
foreach(folder man bash-completion zsh fish)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/share/${folder} DESTINATION share COMPONENT runtime)
endforeach()
install(FILES LICENSE NOTICE README.md CHANGELOG.md CITATION.cff DESTINATION share/doc/weft
  COMPONENT runtime)

install(DIRECTORY framework/include/weft DESTINATION include COMPONENT dev)
install(DIRECTORY ${PROJECT_BINARY_DIR}/share/weft/scaffold DESTINATION share/weft COMPONENT dev)
if(TARGET weft_python)
  install(TARGETS weft_python EXPORT weftTargets ARCHIVE DESTINATION lib COMPONENT dev)
  install(FILES framework/python/embed.py framework/python/python_library.hpp
    DESTINATION share/weft/python COMPONENT dev)
  # What travels in libraries; programs import the package from the component `python`.
  install(DIRECTORY framework/python/weft DESTINATION share/weft/python COMPONENT dev
    FILES_MATCHING PATTERN *.py PATTERN __pycache__ EXCLUDE PATTERN programs EXCLUDE)
endif()
# It finds plugins and worker from where it lies, as the program does.
if(NOT WEFT_SANITIZE)
  set(python_packages lib/python3/dist-packages)
  install(DIRECTORY framework/python/weft DESTINATION ${python_packages} COMPONENT python
    FILES_MATCHING PATTERN *.py PATTERN *.pyi PATTERN py.typed PATTERN __pycache__ EXCLUDE)
  if(TARGET weft_python_module)
    install(TARGETS weft_python_module LIBRARY DESTINATION ${python_packages}/weft/programs
      COMPONENT python)
  endif()
endif()
install(TARGETS weft_describe EXPORT weftTargets RUNTIME DESTINATION bin COMPONENT dev)
install(TARGETS weft_sdk EXPORT weftTargets COMPONENT dev)
install(TARGETS weft_host EXPORT weftHostTargets ARCHIVE DESTINATION lib COMPONENT dev)
install(TARGETS weft_testing EXPORT weftTestingTargets ARCHIVE DESTINATION lib COMPONENT dev)
install(TARGETS weft_pipeline EXPORT weftEmbeddingTargets ARCHIVE DESTINATION lib COMPONENT dev)
foreach(set weftTargets weftHostTargets weftTestingTargets weftEmbeddingTargets)
  install(EXPORT ${set} NAMESPACE weft:: DESTINATION ${package} COMPONENT dev)
endforeach()
set(weft_cmake_folder "\${CMAKE_CURRENT_LIST_DIR}")
set(weft_parameter_tables "\${CMAKE_CURRENT_LIST_DIR}/parameter_tables.py")
set(weft_python_folder "\${PACKAGE_PREFIX_DIR}/share/weft/python")
get_property(weft_python_executable GLOBAL PROPERTY WEFT_PYTHON_EXECUTABLE)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/weftConfig.cmake.in
  ${PROJECT_BINARY_DIR}/installed/weftConfig.cmake INSTALL_DESTINATION ${package})
# Until the boundary is frozen, host and plugin must match in each minor version.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/installed/weftConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
set(weft_pc_prefix "\${pcfiledir}/../..")
set(weft_pc_includedir "\${prefix}/include")
set(weft_pc_plugin_folder "\${prefix}/lib/weft/plugins")
configure_file(${CMAKE_CURRENT_LIST_DIR}/weft.pc.in ${PROJECT_BINARY_DIR}/installed/weft.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/installed/weftConfig.cmake
  ${PROJECT_BINARY_DIR}/installed/weftConfigVersion.cmake
  ${CMAKE_CURRENT_LIST_DIR}/WeftPlugin.cmake ${CMAKE_CURRENT_LIST_DIR}/WeftPythonPlugin.cmake
  ${CMAKE_CURRENT_LIST_DIR}/WeftOpenCV.cmake
  ${CMAKE_CURRENT_LIST_DIR}/weft_plugin.map ${PROJECT_SOURCE_DIR}/scripts/parameter_tables.py
  DESTINATION ${package} COMPONENT dev)
install(FILES ${PROJECT_BINARY_DIR}/installed/weft.pc DESTINATION lib/pkgconfig COMPONENT dev)

weft_built_before_installing(runtime weft weft_worker weft_count_allocations)
weft_built_before_installing(plugins weft_calibrate)
weft_built_before_installing(dev weft_python weft_describe weft_host weft_testing weft_pipeline)
weft_built_before_installing(python weft_python_module)

# For find_package(weft) with weft_DIR set to the build tree.
set(with_python "")
if(TARGET weft_python)
  set(with_python weft_python)
endif()
export(TARGETS weft_sdk weft_describe ${with_python} weft weft_worker NAMESPACE weft::
  FILE ${PROJECT_BINARY_DIR}/weftTargets.cmake)
export(TARGETS weft_host weft_options NAMESPACE weft::
  FILE ${PROJECT_BINARY_DIR}/weftHostTargets.cmake)
export(TARGETS weft_testing NAMESPACE weft:: FILE ${PROJECT_BINARY_DIR}/weftTestingTargets.cmake)
export(TARGETS weft_pipeline NAMESPACE weft:: FILE ${PROJECT_BINARY_DIR}/weftEmbeddingTargets.cmake)
set(weft_cmake_folder ${CMAKE_CURRENT_LIST_DIR})
set(weft_parameter_tables ${PROJECT_SOURCE_DIR}/scripts/parameter_tables.py)
set(weft_python_folder ${PROJECT_SOURCE_DIR}/framework/python)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/weftConfig.cmake.in
  ${PROJECT_BINARY_DIR}/weftConfig.cmake INSTALL_DESTINATION ${PROJECT_BINARY_DIR}
  INSTALL_PREFIX ${PROJECT_BINARY_DIR})
# And for pkg-config with PKG_CONFIG_PATH set to it.
set(weft_pc_prefix "\${pcfiledir}")
set(weft_pc_includedir ${PROJECT_SOURCE_DIR}/framework/include)
configure_file(${CMAKE_CURRENT_LIST_DIR}/weft.pc.in ${PROJECT_BINARY_DIR}/weft.pc @ONLY)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME weft)
set(CPACK_PACKAGE_VENDOR Weft)
set(CPACK_PACKAGE_CONTACT "Weft maintainers")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY
  "3D shape of a deforming surface from one camera and a template")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL runtime plugins dev)
if(NOT WEFT_SANITIZE)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME weft)
set(CPACK_DEBIAN_PLUGINS_PACKAGE_NAME weft-plugins)
set(CPACK_DEBIAN_PLUGINS_PACKAGE_RECOMMENDS python3-numpy)  # of those that are written in Python
set(CPACK_DEBIAN_DEV_PACKAGE_NAME weft-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "cmake (>= 3.25)")
set(CPACK_DEBIAN_DEV_PACKAGE_RECOMMENDS "libeigen3-dev")
# What the components testing and embedding are linked with, tests of plugins, and plugins in Python.
set(CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS "libboost-filesystem-dev, libyaml-cpp-dev, libminizip-dev, \
libxxhash-dev, libgtest-dev, libgmock-dev, nlohmann-json3-dev, pkg-config, python3-dev, python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-weft)
get_property(python_versions GLOBAL PROPERTY WEFT_PYTHON_MODULE_VERSIONS)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "${python_versions}python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "weft-plugins, python3-matplotlib, python3-xxhash")
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION
  "The program weft, its manual pages, its report page and its pipelines.")
set(CPACK_COMPONENT_PLUGINS_DESCRIPTION "The plugins of Weft: sources to sinks.")
set(CPACK_COMPONENT_DEV_DESCRIPTION
  "What plugins for Weft are built with, and programs that embed its pipelines.")
set(CPACK_COMPONENT_PYTHON_DESCRIPTION
  "Pipelines of Weft in programs in Python; its runs and results as NumPy, drawings.")
set(CPACK_COMPONENT_PLUGINS_DEPENDS runtime)
set(CPACK_COMPONENT_DEV_DEPENDS runtime)
include(CPack)
