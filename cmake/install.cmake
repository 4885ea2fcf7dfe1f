# What `cmake --install` puts where, so that another project can say find_package(talus) and link talus::talus.
include(CMakePackageConfigHelpers)

install(TARGETS talus EXPORT talus-targets)
install(DIRECTORY src/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/talus FILES_MATCHING PATTERN "*.hpp")

set(talus_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/talus)
install(EXPORT talus-targets NAMESPACE talus:: DESTINATION ${talus_package_dir})
configure_package_config_file(cmake/talus-config.cmake.in talus-config.cmake INSTALL_DESTINATION ${talus_package_dir})
write_basic_package_version_file(talus-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/talus-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/talus-config-version.cmake
    DESTINATION ${talus_package_dir})
