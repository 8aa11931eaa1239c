# Install and export, so that find_package(trueblade) works.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
get_property(trueblade_libraries GLOBAL PROPERTY TRUEBLADE_LIBRARIES)
install(TARGETS ${trueblade_libraries} EXPORT truebladeTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
foreach(folder geometry part registration hardware calibration sim inspection)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/trueblade
          FILES_MATCHING PATTERN "*.h")
endforeach()
install(EXPORT truebladeTargets NAMESPACE trueblade:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/trueblade)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/truebladeConfig.cmake.in
  ${PROJECT_BINARY_DIR}/truebladeConfig.cmake INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/trueblade)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/truebladeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/truebladeConfig.cmake ${PROJECT_BINARY_DIR}/truebladeConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/trueblade)
