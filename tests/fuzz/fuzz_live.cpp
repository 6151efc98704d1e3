// Fuzz targets of what a live session receives: a page's connection and a device's packets.
#include "fuzz_support.h"

#include "session/hand_gate.h"
#include "session/page_wish.h"
#include "session/session_limits.h"
#include "session/web_policy.h"

#include <boost/asio.hpp>
#include <boost/beast.hpp>
#include <boost/beast/_experimental/test/stream.hpp>

#include <cmath>

namespace seldinger::fuzz {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using boost::system::error_code;
using Request = http::request<http::empty_body>;

/// With every combination of address and token that a session may have.
void ask_for_admission(const Request& request)
{
    const auto text = [&](http::field field) { return std::string_view(request[field].data(), request[field].size()); };
    const WebRequest asks{{request.target().data(), request.target().size()}, text(http::field::host), text(http::field::origin),
                          text(http::field::cookie)};
    for (const char* address : {"127.0.0.1", "0.0.0.0"})
        for (const char* token : {"", "secret"}) (void)admit(asks, address, token);
}

void require_bounds(const PageWish& wish)
{
    require(std::abs(wish.push) <= 0.2 && std::abs(wish.turn) <= 20);
    require(wish.instrument >= 0 && wish.instrument < most_instruments);
}

void converse(websocket::stream<beast::test::stream>& socket)
{
    beast::flat_buffer message{most_message_bytes};
    PageWish wish;
    for (error_code error; socket.read(message, error), !error;) {
        bool reset = false;
        const auto said = message.cdata();
        if (socket.got_text()) (void)read_wish({static_cast<const char*>(said.data()), said.size()}, wish, reset);
        require_bounds(wish);
        message.consume(message.size());
    }
}

}  // namespace

/// A request and, where it is a WebSocket's, frames: read as session/web_server.cpp reads them.
void web(Bytes bytes)
{
    const std::vector<std::string> parts = parts_of(bytes, 2);
    asio::io_context context{1};
    beast::test::stream stream(context, parts[0]);
    beast::test::stream page = beast::test::connect(stream);
    stream.close_remote();  // what has been put in is still read
    beast::flat_buffer buffer{most_header_bytes};
    http::request_parser<http::empty_body> parser;
    parser.header_limit(most_header_bytes);
    parser.body_limit(0);
    error_code error;
    http::read(stream, buffer, parser, error);
    if (error) return;
    const Request request = parser.release();
    ask_for_admission(request);
    if (!websocket::is_upgrade(request)) return;
    stream.append(parts[1]);
    websocket::stream<beast::test::stream> socket(std::move(stream));
    socket.read_message_max(most_message_bytes);
    socket.accept(request, error);
    if (!error) converse(socket);
}

/// Packets, each after the time since the last one and its sender, a byte each.
void hand(Bytes bytes)
{
    HandGate gate(2);
    double now = 0;
    while (bytes.size() > 2) {
        now += bytes[0] / 256.0;
        const std::uint64_t sender = bytes[1] % 3;
        bytes = bytes.subspan(2);
        const std::size_t size = std::min<std::size_t>(bytes.size(), SEL_HAND_REQUEST_BYTES);
        SelHandRequest request;
        const auto verdict = gate.take(bytes.data(), size, sender, now, request);
        require(verdict != HandGate::Verdict::Accepted || request.instrument < 2);
        bytes = bytes.subspan(size);
    }
    for (int k = 0; k < 2; ++k) require(std::isfinite(gate.hand(k).advance) && std::isfinite(gate.hand(k).turn));
}

}  // namespace seldinger::fuzz
