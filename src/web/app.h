// The web app, built from ui/ and part of the program: compressed by gzip.
#pragma once

#include <span>
#include <string_view>

#include "http/http_server.h"

namespace culprit::web {

// Empty if the program was built where npm is not installed.
std::span<const http::Asset> app();

// The document that describes the API (OpenAPI 3.1, openapi.json).
std::string_view openapi();

}  // namespace culprit::web
