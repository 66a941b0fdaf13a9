// Linux: no_new_privs, a filter of system calls, limits of resources.
#include "base/system/confinement.h"

#if defined(__linux__) && (defined(__x86_64__) || defined(__aarch64__))

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <span>

namespace sparsha::system {
namespace {

#if defined(__x86_64__)
constexpr unsigned kArchitecture = AUDIT_ARCH_X86_64;
#else
constexpr unsigned kArchitecture = AUDIT_ARCH_AARCH64;
#endif
constexpr unsigned kSecondAbi = 0x40000000U;  // x32's numbers begin here; arm64 has none so high

constexpr auto kPowers = std::to_array<long>({
    SYS_ptrace,
    SYS_process_vm_readv,
    SYS_process_vm_writev,
    SYS_mount,
    SYS_umount2,
    SYS_pivot_root,
    SYS_chroot,
    SYS_setns,
    SYS_unshare,
    SYS_init_module,
    SYS_finit_module,
    SYS_delete_module,
    SYS_kexec_load,
    SYS_bpf,
    SYS_perf_event_open,
    SYS_userfaultfd,
    SYS_keyctl,
    SYS_add_key,
    SYS_request_key,
    SYS_reboot,
    SYS_swapon,
    SYS_swapoff,
    SYS_settimeofday,
    SYS_clock_settime,
    SYS_sethostname,
    SYS_acct,
    SYS_quotactl,
    SYS_fsopen,
    SYS_fsmount,
    SYS_open_tree,
    SYS_move_mount,
    SYS_kexec_file_load,
    SYS_pidfd_getfd,
    SYS_io_uring_setup,  // its operations pass no filter
});
constexpr auto kProgramsAndFiles = std::to_array<long>({
  SYS_execve, SYS_execveat, SYS_unlinkat, SYS_renameat2, SYS_mkdirat, SYS_mknodat, SYS_linkat, SYS_symlinkat,
      SYS_fchmod, SYS_fchmodat, SYS_fchown, SYS_fchownat, SYS_truncate, SYS_setxattr, SYS_lsetxattr, SYS_fsetxattr,
      SYS_openat2,
#if defined(__x86_64__)
      SYS_unlink, SYS_rename, SYS_renameat, SYS_mkdir, SYS_rmdir, SYS_mknod, SYS_link, SYS_symlink, SYS_chmod,
      SYS_chown, SYS_lchown, SYS_creat,
#endif
});

/// A program of the kernel's for each system call; there is no going back in it, so that each line stands alone.
class Filter {
 public:
  Filter() {
    load(offsetof(seccomp_data, arch));
    // A call by another architecture's numbers is none that this program makes.
    add(BPF_JMP | BPF_JEQ | BPF_K, kArchitecture, 1, 0);
    refuse();
    load(offsetof(seccomp_data, nr));
    add(BPF_JMP | BPF_JGE | BPF_K, kSecondAbi, 0, 1);
    refuse();
  }

  void refuse_calls(std::span<const long> numbers) {
    for (const long number : numbers) {
      add(BPF_JMP | BPF_JEQ | BPF_K, static_cast<unsigned>(number), 0, 1);
      refuse();
    }
  }
  /// Where one of these bits is set in the call's argument.
  void refuse_bits(long number, unsigned argument, unsigned bits) {
    add(BPF_JMP | BPF_JEQ | BPF_K, static_cast<unsigned>(number), 0, 4);
    load_argument(argument);
    add(BPF_JMP | BPF_JSET | BPF_K, bits, 0, 1);
    refuse();
    load(offsetof(seccomp_data, nr));
  }
  /// Where the call's argument is something else.
  void refuse_all_but(long number, unsigned argument, unsigned value) {
    add(BPF_JMP | BPF_JEQ | BPF_K, static_cast<unsigned>(number), 0, 4);
    load_argument(argument);
    add(BPF_JMP | BPF_JEQ | BPF_K, value, 1, 0);
    refuse();
    load(offsetof(seccomp_data, nr));
  }

  bool install() {
    add(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
    const sock_fprog program{static_cast<unsigned short>(size_), lines_.data()};
    return ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
  }

 private:
  void load(std::size_t offset) { add(BPF_LD | BPF_W | BPF_ABS, static_cast<unsigned>(offset)); }
  /// Its lower half; both architectures are little-endian.
  void load_argument(unsigned argument) { load(offsetof(seccomp_data, args) + argument * sizeof(__u64)); }
  void refuse() { add(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM); }
  void add(unsigned code, unsigned value, unsigned if_true = 0, unsigned if_false = 0) {
    lines_[size_++] = {static_cast<__u16>(code), static_cast<__u8>(if_true), static_cast<__u8>(if_false), value};
  }

  std::array<sock_filter, 200> lines_{};
  std::size_t size_ = 0;
};

static_assert(2 * (kPowers.size() + kProgramsAndFiles.size()) + 40 < 200);

}  // namespace

bool confine_thread(Confinement what) noexcept {
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return false;
  Filter filter;
  filter.refuse_calls(kPowers);
  if (what == Confinement::watch) {
    filter.refuse_calls(kProgramsAndFiles);
    constexpr unsigned kFlagsOfOpenat = 2;
    filter.refuse_bits(SYS_openat, kFlagsOfOpenat, O_CREAT | (O_TMPFILE & ~O_DIRECTORY));
#if defined(__x86_64__)
    filter.refuse_bits(SYS_open, 1, O_CREAT | (O_TMPFILE & ~O_DIRECTORY));
#endif
    filter.refuse_all_but(SYS_socket, 0, AF_UNIX);
  }
  return filter.install();
}

void limit_helper(long process) noexcept {
  constexpr rlim_t kFiles = 256;
  constexpr rlim_t kAddresses = rlim_t{4} << 30U;
  constexpr rlim_t kComputing_s = 600;
  const auto limit = [&](__rlimit_resource resource, rlim_t most) {
    rlimit now{};
    if (::prlimit(static_cast<pid_t>(process), resource, nullptr, &now) != 0 || now.rlim_max < most) return;
    now = {most, most};
    static_cast<void>(::prlimit(static_cast<pid_t>(process), resource, &now, nullptr));
  };
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_NOFILE, kFiles);
  limit(RLIMIT_AS, kAddresses);
  limit(RLIMIT_CPU, kComputing_s);
}

}  // namespace sparsha::system

#else

namespace sparsha::system {

bool confine_thread(Confinement) noexcept { return false; }
void limit_helper(long) noexcept {}

}  // namespace sparsha::system

#endif
