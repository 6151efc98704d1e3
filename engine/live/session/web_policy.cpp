// Token, origin and host of a web request.
#include "session/web_policy.h"

#include "core/error.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>

namespace seldinger {
namespace {

/// "[::1]:8080" -> "[::1]", "a:80" -> "a"
std::string_view without_port(std::string_view host)
{
    const std::size_t colon = host.rfind(':');
    const bool is_port = colon != std::string_view::npos && host.find(']', colon) == std::string_view::npos;
    return is_port ? host.substr(0, colon) : host;
}

std::string_view value_after(std::string_view list, std::string_view name, char between)
{
    while (!list.empty()) {
        const std::size_t end = std::min(list.find(between), list.size());
        std::string_view item = list.substr(0, end);
        while (item.starts_with(' ')) item.remove_prefix(1);
        if (item.starts_with(name) && item.size() > name.size() && item[name.size()] == '=') return item.substr(name.size() + 1);
        list.remove_prefix(std::min(end + 1, list.size()));
    }
    return {};
}

}  // namespace

bool is_loopback(std::string_view address)
{
    if (address == "::1" || address == "[::1]" || address == "localhost") return true;
    // a number of 127.0.0.0/8 and not a name that begins so, 127.example.com, which whoever owns it may let point here
    in_addr number{};
    const bool is_number = address.find_first_not_of("0123456789.") == std::string_view::npos &&
                           inet_pton(AF_INET, std::string(address).c_str(), &number) == 1;
    return is_number && address.starts_with("127.");
}

bool same_secret(std::string_view a, std::string_view b)
{
    unsigned differ = a.size() != b.size();
    for (std::size_t k = 0; k < a.size(); ++k)
        differ |= static_cast<unsigned char>(a[k]) ^ static_cast<unsigned char>(b.empty() ? '\0' : b[k % b.size()]);
    return differ == 0;
}

bool is_token(std::string_view text)
{
    constexpr std::string_view unreserved = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~";
    return text.size() >= least_token && text.find_first_not_of(unreserved) == std::string_view::npos;
}

std::string make_token()
{
    std::array<unsigned char, 16> random{};
    if (getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size()))
        throw Error(ErrorKind::BadFile, "the system gave no random numbers for a token; give one with --token");
    std::string text;
    for (const unsigned char byte : random) text += fmt::format("{:02x}", byte);
    return text;
}

std::string in_url(const std::string& address)
{
    return address.find(':') == std::string::npos || address.starts_with('[') ? address : "[" + address + "]";
}

std::string query_value(std::string_view target, std::string_view name)
{
    const std::size_t question = target.find('?');
    return question == std::string_view::npos ? "" : std::string(value_after(target.substr(question + 1), name, '&'));
}

std::string cookie_value(std::string_view cookies, std::string_view name) { return std::string(value_after(cookies, name, ';')); }

Admission admit(const WebRequest& request, std::string_view bound_to, std::string_view token)
{
    const std::string_view host = without_port(request.host);
    const bool own_name = is_loopback(host) || host == in_url(std::string(bound_to));
    if (!own_name && token.empty()) return Admission::WrongHost;
    if (!request.origin.empty()) {
        const std::size_t scheme = request.origin.find("://");
        if (scheme == std::string_view::npos || request.origin.substr(scheme + 3) != request.host) return Admission::WrongOrigin;
    }
    if (token.empty()) return Admission::Welcome;
    const std::string given = query_value(request.target, "token"), kept = cookie_value(request.cookie, "seldinger_token");
    return same_secret(given, token) || same_secret(kept, token) ? Admission::Welcome : Admission::WrongToken;
}

bool WrongTokens::may_try(const std::string& address, double now)
{
    const auto known = of_.find(address);
    return known == of_.end() || known->second.is_left(now);
}

void WrongTokens::count(const std::string& address, double now)
{
    if (of_.size() >= most_addresses && !of_.contains(address))
        of_.erase(std::min_element(of_.begin(), of_.end(),
                                   [](const auto& a, const auto& b) { return a.second.last() < b.second.last(); }));
    (void)of_.try_emplace(address, per_second, at_once, now).first->second.allow(now);
}

}  // namespace seldinger
