// SPDX-License-Identifier: MIT
/// Takes the place of pointsweep/threads.cpp in the program pointsweep_traced. The code of threads.cpp runs the loops
/// and background tasks (untraced_threads.cpp). When the program ends, a record of them is written to the file that
/// SPAN_TRACE names, for replay.py.
///
/// SPAN_REAL=R: the program plans for its --threads N (thread_count() says N), but only R threads work. So a machine of
/// two cores traces a run planned for 64 threads, with the chunks, groups and read-ahead of 64 threads, and no piece of
/// work is slowed down by the others. Times are CPU times of threads, less the time of the tracer itself (event_ns,
/// calibrated at the start).
#include <execinfo.h>
#include <link.h>
#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>
#include <unwind.h>
#include <x86intrin.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "bench/span/untraced_threads.h"
#include "pointsweep/threads.h"

#ifndef sigev_notify_thread_id
#define sigev_notify_thread_id _sigev_un._tid
#endif

extern "C" {
int __real_pthread_mutex_lock(pthread_mutex_t* mutex);
int __real_pthread_mutex_unlock(pthread_mutex_t* mutex);
int __wrap_pthread_mutex_lock(pthread_mutex_t* mutex);
int __wrap_pthread_mutex_unlock(pthread_mutex_t* mutex);
}

namespace span_trace {

enum Kind : std::uint64_t {
  kLoopBegin = 1,
  kLoopEnd,
  kIterationBegin,
  kIterationEnd,
  kSpawn,
  kTaskBegin,
  kTaskEnd,
  kWaitBegin,
  kWaitEnd,
  kLock,
  kUnlock,
  kCall,  // with_threads(), on the calling thread
  kCallEnd,
  kCalled,  // the work of with_threads(), perhaps on another thread
  kCalledEnd,
};

struct Event {
  std::uint64_t cpu;   ///< ns
  std::uint64_t what;  ///< kind << 56 | id
  std::uint64_t a, b;  ///< count or index; site or return address; depending on the kind
};

constexpr int kFrames = 28;
struct Sample {
  std::uint64_t cpu;
  std::uint32_t depth;
  void* frames[kFrames];
};
constexpr std::size_t kChunk = 1 << 15, kMostSamples = 1 << 16;

struct Thread {
  pid_t tid;
  std::uint64_t overhead = 0;                ///< ns of the tracer
  std::uint64_t last_cpu = 0, last_tsc = 0;  ///< at the last event whose time the kernel gave
  std::vector<Event*> chunks;
  std::size_t used = kChunk;  ///< number of events in the last chunk
  Sample* samples = nullptr;
  std::size_t sample_count = 0;
  std::unordered_map<std::uint64_t, std::uint64_t> sites;  ///< by return address and stack pointer
};

struct Site {
  int depth;
  void* frames[kFrames];
};

struct All {
  pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
  std::vector<std::unique_ptr<Thread>> threads;
  std::vector<Site> sites;
  std::atomic<std::uint64_t> next_id{1};
  std::uint64_t event_ns = 0, lock_tsc = 0, wall_begin = 0, cpu_begin = 0;
  double ns_per_tsc = 0;
  unsigned planned = 0, real = 0;
  const char* path = nullptr;
};

All& all() {
  static All* const it = new All;  // never deleted, since threads use it until the process ends
  return *it;
}

__thread Thread* self = nullptr;
__thread sigjmp_buf unwinding;
__thread volatile bool may_fault = false;

std::uint64_t clock_ns(clockid_t clock) {
  timespec t;
  clock_gettime(clock, &t);
  return static_cast<std::uint64_t>(t.tv_sec) * 1000000000u + static_cast<std::uint64_t>(t.tv_nsec);
}

_Unwind_Reason_Code note_frame(_Unwind_Context* context, void* sample) {
  auto& s = *static_cast<Sample*>(sample);
  s.frames[s.depth++] = reinterpret_cast<void*>(_Unwind_GetIP(context));
  return s.depth == kFrames ? _URC_END_OF_STACK : _URC_NO_REASON;
}

/// Unwinding may reach invalid addresses, since the compiler's tables are not valid for every instruction of a function
/// that aligns its stack.
void on_fault(int signal_number, siginfo_t*, void*) {
  if (may_fault) siglongjmp(unwinding, 1);
  signal(signal_number, SIG_DFL);
}

void on_sample(int, siginfo_t*, void*) {
  Thread* const t = self;
  if (t == nullptr || t->sample_count == kMostSamples) return;
  const int before = errno;
  const std::uint64_t tsc = __rdtsc();
  const std::uint64_t start = clock_ns(CLOCK_THREAD_CPUTIME_ID);
  Sample& s = t->samples[t->sample_count++];
  s.cpu = start - t->overhead;
  s.depth = 0;
  if (sigsetjmp(unwinding, 0) == 0) {
    may_fault = true;
    _Unwind_Backtrace(note_frame, &s);
  }
  may_fault = false;
  t->overhead += clock_ns(CLOCK_THREAD_CPUTIME_ID) - start;
  t->last_tsc += __rdtsc() - tsc;
  errno = before;
}

void attach() {
  if (all().path == nullptr) return;
  auto made = std::make_unique<Thread>();
  made->tid = static_cast<pid_t>(syscall(SYS_gettid));
  made->samples = static_cast<Sample*>(mmap(nullptr, kMostSamples * sizeof(Sample), PROT_READ | PROT_WRITE,
                                            MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0));
  self = made.get();
  sigevent how{};
  how.sigev_notify = SIGEV_THREAD_ID;
  how.sigev_signo = SIGRTMIN + 3;
  how.sigev_notify_thread_id = self->tid;
  timer_t timer;
  if (timer_create(CLOCK_THREAD_CPUTIME_ID, &how, &timer) == 0) {  // expires at ticks of the kernel: every 4 ms at 250
                                                                   // Hz
    const itimerspec every{{0, 1000000}, {0, 1000000}};
    timer_settime(timer, 0, &every, nullptr);
  }
  __real_pthread_mutex_lock(&all().mutex);
  all().threads.push_back(std::move(made));
  __real_pthread_mutex_unlock(&all().mutex);
}

inline void put(Thread* t, const Event& event) {
  if (t->used == kChunk) {
    t->chunks.push_back(new Event[kChunk]);
    t->used = 0;
  }
  t->chunks.back()[t->used++] = event;
}

inline void record(Kind kind, std::uint64_t id, std::uint64_t a = 0, std::uint64_t b = 0) {
  Thread* t = self;
  if (t == nullptr) {
    attach();
    if ((t = self) == nullptr) return;
  }
  const std::uint64_t overhead = t->overhead;
  const std::uint64_t cpu = clock_ns(CLOCK_THREAD_CPUTIME_ID) - overhead;
  put(t, {cpu, kind << 56 | id, a, b});
  t->overhead += all().event_ns;
  t->last_cpu = cpu;
  t->last_tsc = __rdtsc();
}

/// Locks are many and short. Their times are extrapolated, by the clock of the processor, from the last event whose
/// time the kernel gave. If the thread was interrupted since, the next event with a time of the kernel corrects them.
inline void record_lock(Kind kind, const void* mutex, const void* at) {
  constexpr std::uint64_t kLongest = 20'000'000;  // cycles
  Thread* const t = self;
  const std::uint64_t tsc = __rdtsc(), passed = tsc > t->last_tsc ? tsc - t->last_tsc : 0;
  const auto id = reinterpret_cast<std::uint64_t>(mutex), a = reinterpret_cast<std::uint64_t>(at);
  if (passed > kLongest) return record(kind, id, a);
  put(t, {t->last_cpu + static_cast<std::uint64_t>(static_cast<double>(passed) * all().ns_per_tsc), kind << 56 | id, a,
          0});
  t->last_tsc += all().lock_tsc;
}

/// Returns the number of the place that started a loop; 0 on a thread without a trace. The stack of the place is
/// recorded at the first loop that has the same return address `caller` and the same `frame`.
__attribute__((noinline)) std::uint64_t site_of(void* caller, void* frame) {
  Thread* const t = self;
  if (t == nullptr) return 0;
  const std::uint64_t start = clock_ns(CLOCK_THREAD_CPUTIME_ID);
  std::uint64_t& id =
      t->sites[reinterpret_cast<std::uint64_t>(caller) * 0x9E3779B97F4A7C15u ^ reinterpret_cast<std::uint64_t>(frame)];
  if (id == 0) {
    Site site;
    site.depth = backtrace(site.frames, kFrames);
    __real_pthread_mutex_lock(&all().mutex);
    all().sites.push_back(site);
    id = all().sites.size();
    __real_pthread_mutex_unlock(&all().mutex);
  }
  t->overhead += clock_ns(CLOCK_THREAD_CPUTIME_ID) - start;
  return id;
}

std::string json_text(const std::string& text) {
  std::string out = "\"";
  for (const char c : text)
    if (c == '"' || c == '\\')
      (out += '\\') += c;
    else if (static_cast<unsigned char>(c) >= 32)
      out += c;
  return out + "\"";
}

int note_module(dl_phdr_info* info, std::size_t, void* out) {
  std::string name = info->dlpi_name;
  if (name.empty()) {
    char exe[4096];
    const ssize_t n = readlink("/proc/self/exe", exe, sizeof exe);
    name.assign(exe, n > 0 ? static_cast<std::size_t>(n) : 0);
  }
  std::uint64_t end = 0;
  for (int i = 0; i < info->dlpi_phnum; ++i)
    if (info->dlpi_phdr[i].p_type == PT_LOAD)
      end = std::max<std::uint64_t>(end, info->dlpi_phdr[i].p_vaddr + info->dlpi_phdr[i].p_memsz);
  std::string& text = *static_cast<std::string*>(out);
  text += (text.empty() ? "[" : ", [") + std::to_string(info->dlpi_addr) + ", " +
          std::to_string(info->dlpi_addr + end) + ", " + json_text(name) + "]";
  return 0;
}

void write_trace() {
  const std::uint64_t main_cpu = self != nullptr ? clock_ns(CLOCK_THREAD_CPUTIME_ID) - self->overhead : 0;
  const std::uint64_t cpu = clock_ns(CLOCK_PROCESS_CPUTIME_ID), wall = clock_ns(CLOCK_MONOTONIC);
  const pid_t main_tid = static_cast<pid_t>(syscall(SYS_gettid));
  signal(SIGRTMIN + 3, SIG_IGN);
  std::string modules, argv, threads;
  dl_iterate_phdr(note_module, &modules);
  std::ifstream line("/proc/self/cmdline");
  for (std::string word; std::getline(line, word, '\0');) argv += (argv.empty() ? "" : ", ") + json_text(word);
  for (const auto& t : all().threads) {
    const std::size_t events = t->chunks.empty() ? 0 : (t->chunks.size() - 1) * kChunk + t->used;
    threads += (threads.empty() ? "" : ", ") + std::string("{\"tid\": ") + std::to_string(t->tid) +
               ", \"events\": " + std::to_string(events) + ", \"samples\": " + std::to_string(t->sample_count) +
               ", \"overhead_ns\": " + std::to_string(t->overhead) + "}";
  }
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  const std::string head =
      "{\"planned\": " + std::to_string(all().planned) + ", \"real\": " + std::to_string(all().real) +
      ", \"event_ns\": " + std::to_string(all().event_ns) + ", \"lock_tsc\": " + std::to_string(all().lock_tsc) +
      ", \"ns_per_tsc\": " + std::to_string(all().ns_per_tsc) + ", \"main_tid\": " + std::to_string(main_tid) +
      ", \"main_cpu\": " + std::to_string(main_cpu) + ", \"process_cpu\": " + std::to_string(cpu) +
      ", \"wall_begin\": " + std::to_string(all().wall_begin) + ", \"wall_end\": " + std::to_string(wall) +
      ", \"main_cpu_begin\": " + std::to_string(all().cpu_begin) +
      ", \"max_rss_kb\": " + std::to_string(usage.ru_maxrss) + ", \"frames\": " + std::to_string(kFrames) +
      ", \"sites\": " + std::to_string(all().sites.size()) + ", \"argv\": [" + argv + "], \"modules\": [" + modules +
      "], \"threads\": [" + threads + "]}";
  std::FILE* const file = std::fopen(all().path, "wb");
  if (file == nullptr) return std::perror("SPAN_TRACE");
  const std::uint64_t bytes = head.size();
  std::fwrite("PSSPAN1\n", 1, 8, file);
  std::fwrite(&bytes, sizeof bytes, 1, file);
  std::fwrite(head.data(), 1, head.size(), file);
  const auto put_frames = [file](void* const* frames, std::size_t depth) {
    void* row[kFrames] = {};
    std::copy_n(frames, depth, row);
    std::fwrite(row, sizeof row, 1, file);
  };
  for (const Site& site : all().sites) put_frames(site.frames, static_cast<std::size_t>(site.depth));
  for (const auto& t : all().threads) {
    for (std::size_t c = 0; c < t->chunks.size(); ++c)
      std::fwrite(t->chunks[c], sizeof(Event), c + 1 < t->chunks.size() ? kChunk : t->used, file);
    for (std::size_t s = 0; s < t->sample_count; ++s) {
      std::fwrite(&t->samples[s].cpu, sizeof(std::uint64_t), 1, file);
      put_frames(t->samples[s].frames, t->samples[s].depth);
    }
  }
  const std::uint64_t end = clock_ns(CLOCK_MONOTONIC);
  std::fwrite(&end, sizeof end, 1, file);  // the end of the record
  std::fclose(file);
}

__attribute__((constructor)) void start() {
  all().path = std::getenv("SPAN_TRACE");
  if (all().path == nullptr) return;
  void* some[4];
  backtrace(some, 4);  // loads the unwinder here, and not in a signal handler
  struct sigaction act {};
  act.sa_sigaction = on_sample;
  act.sa_flags = SA_RESTART | SA_SIGINFO;
  sigaction(SIGRTMIN + 3, &act, nullptr);
  act.sa_sigaction = on_fault;
  act.sa_flags = SA_NODEFER | SA_SIGINFO;
  for (const int fault : {SIGSEGV, SIGBUS}) sigaction(fault, &act, nullptr);
  all().wall_begin = clock_ns(CLOCK_MONOTONIC);
  all().cpu_begin = clock_ns(CLOCK_THREAD_CPUTIME_ID);
  attach();
  const std::uint64_t first = clock_ns(CLOCK_THREAD_CPUTIME_ID);
  constexpr int kTimes = 4000;
  for (int i = 0; i < kTimes; ++i) record(kUnlock, 0);
  const std::uint64_t spent = clock_ns(CLOCK_THREAD_CPUTIME_ID) - first;
  all().event_ns = spent / kTimes;
  const std::uint64_t wall = clock_ns(CLOCK_MONOTONIC), tsc = __rdtsc();
  while (clock_ns(CLOCK_MONOTONIC) < wall + 2'000'000) {
  }
  all().ns_per_tsc = static_cast<double>(clock_ns(CLOCK_MONOTONIC) - wall) / static_cast<double>(__rdtsc() - tsc);
  record(kUnlock, 0);
  const std::uint64_t locks = __rdtsc();
  for (int i = 0; i < kTimes; ++i) record_lock(kUnlock, nullptr, nullptr);
  all().lock_tsc = (__rdtsc() - locks) / kTimes;
  self->used = 0;
  self->overhead = clock_ns(CLOCK_THREAD_CPUTIME_ID) - first;
  self->last_cpu = first;
  self->last_tsc = __rdtsc();
  std::atexit(write_trace);
}

std::uint64_t new_id() { return all().next_id.fetch_add(1, std::memory_order_relaxed); }

struct Span {
  Kind end;
  std::uint64_t id;
  Span(Kind begin, Kind at_end, std::uint64_t of, std::uint64_t a = 0, std::uint64_t b = 0) : end(at_end), id(of) {
    record(begin, id, a, b);
  }
  ~Span() { record(end, id); }
  Span(const Span&) = delete;
  Span& operator=(const Span&) = delete;
};

}  // namespace span_trace

extern "C" int __wrap_pthread_mutex_lock(pthread_mutex_t* mutex) {
  if (span_trace::self == nullptr) return __real_pthread_mutex_lock(mutex);
  if (pthread_mutex_trylock(mutex) == 0) {
    span_trace::record_lock(span_trace::kLock, mutex, __builtin_return_address(0));
    return 0;
  }
  const int rc = __real_pthread_mutex_lock(mutex);
  span_trace::record(span_trace::kLock, reinterpret_cast<std::uint64_t>(mutex),
                     reinterpret_cast<std::uint64_t>(__builtin_return_address(0)));
  return rc;
}

extern "C" int __wrap_pthread_mutex_unlock(pthread_mutex_t* mutex) {
  if (span_trace::self != nullptr) span_trace::record_lock(span_trace::kUnlock, mutex, nullptr);
  return __real_pthread_mutex_unlock(mutex);
}

#define SPAN_SITE span_trace::site_of(__builtin_return_address(0), __builtin_frame_address(0))

namespace pointsweep {
namespace {

std::atomic<unsigned> planned{0};

unsigned real_threads(unsigned threads) {
  const char* const text = std::getenv("SPAN_REAL");
  return text == nullptr ? threads : std::clamp(static_cast<unsigned>(std::atoi(text)), 1u, threads);
}

}  // namespace

__attribute__((noinline)) void with_threads(unsigned threads, const std::function<void()>& work) {
  threads = std::max(threads, 1u);
  const unsigned real = real_threads(threads), before = planned.exchange(threads);
  span_trace::all().planned = threads;
  span_trace::all().real = real;
  const std::uint64_t id = span_trace::new_id();
  const span_trace::Span call(span_trace::kCall, span_trace::kCallEnd, id, threads, SPAN_SITE);
  try {
    untraced::with_threads(real, [&] {
      const span_trace::Span called(span_trace::kCalled, span_trace::kCalledEnd, id);
      work();
    });
  } catch (...) {
    planned = before;
    throw;
  }
  planned = before;
}

unsigned thread_count() {
  const unsigned threads = planned;
  return threads != 0 ? threads : untraced::thread_count();
}

__attribute__((noinline)) void parallel_for(std::size_t count, const std::function<void(std::size_t, unsigned)>& body) {
  const std::uint64_t id = span_trace::new_id();
  const span_trace::Span span(span_trace::kLoopBegin, span_trace::kLoopEnd, id, count, SPAN_SITE);
  untraced::parallel_for(count, [&](std::size_t i, unsigned worker) {
    const span_trace::Span iteration(span_trace::kIterationBegin, span_trace::kIterationEnd, id, i);
    body(i, worker);
  });
}

struct BackgroundTask::State {
  std::uint64_t id = span_trace::new_id();
  std::unique_ptr<untraced::Task> task;
};

__attribute__((noinline)) BackgroundTask::BackgroundTask(std::function<void()> work)
    : state_(std::make_unique<State>()) {
  span_trace::record(span_trace::kSpawn, state_->id, 0, SPAN_SITE);
  state_->task = untraced::start([work = std::move(work), id = state_->id] {
    const span_trace::Span task(span_trace::kTaskBegin, span_trace::kTaskEnd, id);
    work();
  });
}

__attribute__((noinline)) BackgroundTask::~BackgroundTask() {
  const span_trace::Span waiting(span_trace::kWaitBegin, span_trace::kWaitEnd, state_->id, 0, SPAN_SITE);
  state_->task.reset();
}

__attribute__((noinline)) void BackgroundTask::wait() {
  const span_trace::Span waiting(span_trace::kWaitBegin, span_trace::kWaitEnd, state_->id, 0, SPAN_SITE);
  state_->task->wait();
}

}  // namespace pointsweep
