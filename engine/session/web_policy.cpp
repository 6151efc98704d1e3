// Token, origin and host of a web request.
#include "session/web_policy.h"

#include <arpa/inet.h>

#include <algorithm>

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

std::string query_value(std::string_view target, std::string_view name)
{
    const std::size_t question = target.find('?');
    return question == std::string_view::npos ? "" : std::string(value_after(target.substr(question + 1), name, '&'));
}

std::string cookie_value(std::string_view cookies, std::string_view name) { return std::string(value_after(cookies, name, ';')); }

Admission admit(const WebRequest& request, std::string_view bound_to, std::string_view token)
{
    const std::string_view host = without_port(request.host);
    const bool own_name = is_loopback(host) || host == bound_to;
    if (!own_name && token.empty()) return Admission::WrongHost;
    if (!request.origin.empty()) {
        const std::size_t scheme = request.origin.find("://");
        if (scheme == std::string_view::npos || request.origin.substr(scheme + 3) != request.host) return Admission::WrongOrigin;
    }
    if (token.empty()) return Admission::Welcome;
    const std::string given = query_value(request.target, "token"), kept = cookie_value(request.cookie, "seldinger_token");
    return same_secret(given, token) || same_secret(kept, token) ? Admission::Welcome : Admission::WrongToken;
}

}  // namespace seldinger
