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
