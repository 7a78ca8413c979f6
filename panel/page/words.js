// The words of the page: English, Chinese. What the machine says comes from it in both languages.

const WORDS = {
  axes: ["Axes, mm", "坐标 (mm)"],
  machine: ["Machine", "机床"],
  spindle: ["Spindle and overrides", "主轴与倍率"],
  measured: ["Measured", "实测"],
  commanded: ["Commanded", "指令"],
  ov_feed: ["Feed override", "进给倍率"],
  ov_rapid: ["Rapid override", "快速倍率"],
  ov_spindle: ["Spindle override", "主轴倍率"],
  program: ["Program", "程序"],
  line: ["Line, move", "行、移动段"],
  no_line: ["no line is under way", "没有正在执行的程序行"],
  modal: ["In force for the next typed line", "下一输入行的有效状态"],
  not_said: ["the board does not say", "控制板不提供"],
  sync: ["Synchronism error", "同步误差"],
  late: ["Late setpoints", "迟到设定值"],
  messages: ["Alarms and events", "报警与事件"],
  referenced: ["ref.", "已回零"],
  unreferenced: ["not ref.", "未回零"],
  held: ["feed hold", "进给保持"],
  single: ["single block", "单段"],
  dry: ["dry run", "空运行"],
  remedy: ["Remedy", "处理"],
  old: ["s old", "秒前的数据"],
  lost: ["The machine is not heard: it may be moving. Look at the machine, and at the computer of the panel", "收不到机床数据：机床可能仍在运动。请查看机床和运行面板的计算机"],
  hold: ["HOLD", "进给保持"],
  stop: ["STOP", "停止"],
  start: ["START", "启动"],
  start_how: ["hold 0.3 s", "按住 0.3 秒"],
  resume: ["RESUME", "恢复"],
  reset: ["RESET", "复位"],
  orders: ["Orders", "指令"],
  mode: ["Mode", "方式"],
  single_block: ["Single block", "单段"],
  home: ["Home all", "全部回零"],
  by_hand: ["By hand", "手动"],
  rapid_too: ["Rapid", "快速"],
  step_mm: ["Step, mm (X: of the diameter)", "步距 (mm，X 为直径)"],
  mdi: ["Type a line", "输入程序行"],
  do_line: ["Carry out", "执行"],
  done: ["done", "完成"],
  take: ["Operate", "接管操作"],
  give: ["Stop operating", "放弃操作"],
  who_own: ["This page operates", "本页面正在操作"],
  who_other: ["Another page operates", "其他页面正在操作"],
  who_nobody: ["Nobody operates by a page", "没有页面在操作"],
  looks: ["This page looks only", "本页面只能查看"],
  notice: ["another page takes over in", "其他页面接管倒计时"],
  limit: ["at the limit of the travel or a zone", "已到行程极限或禁区"],
  no_answer: ["The panel does not answer: nobody knows whether the order has come. Look at the machine", "面板没有应答：无法确认指令是否送达。请查看机床"],
  stale: ["The values are old: hold, stop and reset alone are ordered", "数据已过时：只能下达保持、停止和复位"],
  less: ["less", "减"],
  more: ["more", "加"],
  login: ["Open the link that the panel has printed when it was started", "请打开面板启动时显示的链接"],
  state_starting: ["Starting", "正在启动"],
  state_idle: ["Idle", "空闲"],
  state_run: ["Running", "运行"],
  state_hold: ["Feed hold", "进给保持"],
  state_dwell: ["Dwell", "暂停延时"],
  state_wait: ["Waiting", "等待"],
  state_stopping: ["Stopping", "正在停止"],
  state_alarm: ["Alarm", "报警"],
  mode_manual: ["Manual", "手动"],
  mode_step: ["Step", "增量"],
  mode_wheel: ["Wheel", "手轮"],
  mode_reference: ["Reference", "回零"],
  mode_mdi: ["MDI", "MDI"],
  mode_automatic: ["Automatic", "自动"],
};

let language = 0;

export const isChinese = () => language === 1;

export function use(zh) {
  language = zh ? 1 : 0;
  document.documentElement.lang = zh ? "zh" : "en";
  for (const one of document.querySelectorAll("[data-word]")) one.textContent = word(one.dataset.word);
  for (const one of document.querySelectorAll("[data-name]")) one.setAttribute("aria-label", word(one.dataset.name));
}

export function word(key) {
  const words = WORDS[key];
  if (!words) throw new Error(`no words for ${key}`);
  return words[language];
}
