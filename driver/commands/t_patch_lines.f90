module t_patch_lines
  !! The lines of a PATCh data set that make it a T-spline: local refinement of what the lines before made, with the
  !! geometry unchanged, and the sweep of a surface into a solid.
  !!
  !!     REFIne BOX x1 x2 y1 y2 [z1 z2] LEVEls=n      cells that reach into a box in space, halved n times each way
  !!     REFIne PARAmeter s1 s2 t1 t2 LEVEls=n        ... in the patch's parameters
  !!     REFIne SIDE=top DISTance=d LEVEls=n          ... nearer than d to a side
  !!     REFIne ELEMents e1 e2 ... LEVEls=n           ... elements of the patch before refinement, first direction fastest
  !!     ROWS SIDE=top ROWS=n [TIMEs=k] [FROM=a TO=b] the first n rows of elements along a side get lines across it
  !!     SPLIt PARAmeter s1 s2 t1 t2 DIRection=d [TIMEs=k]   lines across direction d over a box
  !!     SUITable                                     lengthens lines until no extensions of T-junctions cross
  !!     SWEEp vx vy vz DEGRee=r ELEMents=n [RATIo=q] the surface becomes a solid along a vector
  !!
  !! REFIne keeps the mesh analysis-suitable (Morgenstern and Peterseim 2015). ROWS and SPLIt are free; whether the
  !! result is suitable is checked when the data set ends, and a crossing is named.
  use kinds, only: wp
  use status_codes, only: ok, status_text
  use messages, only: message_log, quoted, known_names, lower_case
  use number_text, only: write_number
  use deck_record, only: record
  use nurbs_patch, only: nurbs_patch_type
  use grading, only: uniform_breaks, graded_breaks
  use t_mesh, only: t_mesh_type, create_t_mesh
  use t_refinement, only: refine_cells, refine_box, cells_in_place, cells_near_side, cells_below_level, rows_at_side, &
    split_box
  use t_suitability, only: check_suitability, make_suitable, crossing_type
  use t_sweep, only: sweep_type, straight_sweep, elevate_sweep, refine_sweep
  implicit none (type, external)
  private
  public :: begin_t_mesh, carry_out_t_line, read_sweep, report_suitability, t_line_words, surface_sides

  character(9), parameter :: t_line_words(5) = [character(9) :: 'REFIne', 'ROWS', 'SPLIt', 'SUITable', 'SWEEp']
  character(6), parameter :: surface_sides(4) = [character(6) :: 'left', 'right', 'bottom', 'top']

contains

  subroutine begin_t_mesh(rec, patch, mesh, log)
    !! The T-mesh of a tensor-product patch.
    type(record), intent(in) :: rec
    type(nurbs_patch_type), intent(in) :: patch
    type(t_mesh_type), intent(out) :: mesh
    type(message_log), intent(inout) :: log
    integer :: status

    if (patch%dp /= 2) then
      call rec%add_error(log, 'only surfaces (two directions) become T-splines', &
        'For a solid, refine the surface and add SWEEp')
      return
    end if
    if (any(mod(patch%knots(1:2)%p, 2) == 0)) then
      call rec%add_error(log, 'a T-spline has odd degrees', 'ELEVate the patch to degree 1, 3 or 5 in each direction first')
      return
    end if
    call create_t_mesh(patch%knots(1:2), mesh, status)
    if (status /= ok) call rec%add_error(log, status_text(status), &
      'A T-mesh starts from open knot vectors')
  end subroutine begin_t_mesh

  subroutine carry_out_t_line(rec, ndm, patch, mesh, sweep, log)
    !! One line.
    type(record), intent(inout) :: rec
    integer, intent(in) :: ndm
    type(nurbs_patch_type), intent(in) :: patch
    type(t_mesh_type), intent(inout) :: mesh
    type(sweep_type), allocatable, intent(inout) :: sweep
    type(message_log), intent(inout) :: log
    integer :: added, status

    select case (rec%key(1))
    case ('refi'); call read_refinement(rec, ndm, patch, mesh, log)
    case ('rows'); call read_rows(rec, mesh, log)
    case ('spli'); call read_split(rec, mesh, log)
    case ('suit')
      call make_suitable(mesh, added, status)
      if (status /= ok) call rec%add_error(log, status_text(status), 'Refine less')
    case ('swee'); call read_sweep(rec, ndm, sweep, log)
    end select
  end subroutine carry_out_t_line

  subroutine read_refinement(rec, ndm, patch, mesh, log)
    type(record), intent(inout) :: rec
    integer, intent(in) :: ndm
    type(nurbs_patch_type), intent(in) :: patch
    type(t_mesh_type), intent(inout) :: mesh
    type(message_log), intent(inout) :: log
    integer :: levels, status, side, last, step, e, error_count
    integer, allocatable :: ids(:), marked(:)
    real(wp) :: box(6), distance
    character(4) :: where_
    logical :: found

    if (.not. mesh%regular) then
      call rec%add_error(log, 'REFIne after ROWS or SPLIt, or on repeated knots, cannot keep the mesh suitable', &
        'Put REFIne first, or use SPLIt')
      return
    end if
    levels = 1
    error_count = log%error_count()
    call rec%check_options([character(8) :: 'side', 'distance', 'levels'], log)
    call rec%integer_option('levels', levels, log)
    if (log%error_count() > error_count) return
    if (levels < 0 .or. levels > 20) then
      call rec%add_error(log, 'LEVEls are 0 to 20', '')
      return
    end if
    last = rec%count
    if (rec%has('levels')) last = rec%find('levels') - 2
    where_ = rec%key(2)
    status = ok
    found = .true.
    select case (where_)
    case ('box')
      box = [-1, 1, -1, 1, -1, 1]*huge(1.0_wp)
      if (last /= 2 + 2*ndm) then
        call rec%add_error(log, 'BOX needs lower and upper bound of each coordinate', 'Write BOX x1 x2 y1 y2')
        return
      end if
      call rec%numbers(3, box(1:2*ndm), log, 'bounds')
      do step = 1, 2*levels
        marked = cells_in_place(mesh, patch, box(1::2), box(2::2))
        found = size(marked) > 0
        marked = cells_below_level(mesh, marked, 2*levels)
        if (size(marked) == 0) exit
        call refine_cells(mesh, marked, status)
        if (status /= ok) exit
      end do
    case ('para')
      if (last /= 6) then
        call rec%add_error(log, 'PARAmeter needs four bounds', 'Write PARAmeter s1 s2 t1 t2')
        return
      end if
      call rec%numbers(3, box(1:4), log, 'bounds')
      found = overlaps(mesh, box([1, 3]), box([2, 4]))
      call refine_box(mesh, box([1, 3]), box([2, 4]), levels, status)
    case ('side')
      call read_side(rec, side, log)
      if (side == 0) return
      distance = 0
      call rec%number_option('distance', distance, log)
      if (.not. distance > 0) then
        call rec%add_error(log, 'the distance from the side is missing', 'Write REFIne SIDE=top DISTance=d LEVEls=n')
        return
      end if
      do step = 1, 2*levels
        marked = cells_below_level(mesh, cells_near_side(mesh, patch, side, distance), 2*levels)
        if (size(marked) == 0) exit
        call refine_cells(mesh, marked, status)
        if (status /= ok) exit
      end do
    case ('elem')
      allocate (ids(max(0, last - 2)))
      call rec%integers(3, ids, log, 'elements')
      found = size(ids) > 0
      associate (n => patch%elements())
        do e = 1, size(ids)
          if (ids(e) >= 1 .and. ids(e) <= product(n(1:2))) cycle
          call rec%add_error(log, 'there is no element '//quoted(rec%word(2 + e)), &
            'Elements are those of the patch before refinement, first direction fastest', 2 + e)
          return
        end do
      end associate
      call refine_elements(mesh, patch, ids, levels, status)
    case default
      call rec%add_error(log, 'where to refine is missing', 'Write REFIne BOX, PARAmeter, SIDE= or ELEMents')
      return
    end select
    if (.not. found) call rec%add_error(log, 'there is nothing to refine there', &
      'No element reaches into the box; bounds come in pairs, the smaller one first')
    if (status /= ok) call rec%add_error(log, status_text(status), 'Refine less')
  end subroutine read_refinement

  pure logical function overlaps(mesh, lo, hi)
    !! Is there anything in a box of parameters?
    type(t_mesh_type), intent(in) :: mesh
    real(wp), intent(in) :: lo(2), hi(2)
    integer :: d

    overlaps = .true.
    do d = 1, 2
      associate (x => mesh%lines(d)%x)
        overlaps = overlaps .and. lo(d) < hi(d) .and. lo(d) < x(ubound(x, 1)) .and. hi(d) > x(lbound(x, 1))
      end associate
    end do
  end function overlaps

  subroutine refine_elements(mesh, patch, ids, levels, status)
    !! Refine the boxes of elements of the patch.
    type(t_mesh_type), intent(inout) :: mesh
    type(nurbs_patch_type), intent(in) :: patch
    integer, intent(in) :: ids(:), levels
    integer, intent(out) :: status
    real(wp), allocatable :: s(:), t(:)
    integer :: e, i, j

    s = patch%knots(1)%breaks()
    t = patch%knots(2)%breaks()
    status = ok
    do e = 1, size(ids)
      i = 1 + mod(ids(e) - 1, size(s) - 1)
      j = 1 + (ids(e) - 1)/(size(s) - 1)
      call refine_box(mesh, [s(i), t(j)], [s(i + 1), t(j + 1)], levels, status)
      if (status /= ok) return
    end do
  end subroutine refine_elements

  subroutine read_side(rec, side, log)
    !! SIDE=name.
    type(record), intent(inout) :: rec
    integer, intent(out) :: side       !! 0 after an error
    type(message_log), intent(inout) :: log
    character(:), allocatable :: name

    side = 0
    if (.not. rec%has('side')) then
      call rec%add_error(log, 'the side is missing', 'Write SIDE=left, right, bottom or top')
      return
    end if
    name = ''
    call rec%text_option('side', name, log)
    do side = 1, 4
      if (lower_case(name) == trim(surface_sides(side))) return
    end do
    call rec%add_error(log, 'there is no side '//quoted(name), known_names(surface_sides, 'sides'))
    side = 0
  end subroutine read_side

  subroutine read_rows(rec, mesh, log)
    type(record), intent(inout) :: rec
    type(t_mesh_type), intent(inout) :: mesh
    type(message_log), intent(inout) :: log
    integer :: side, rows, times, halved, along
    real(wp) :: lo(2), hi(2)

    call read_side(rec, side, log)
    if (side == 0) return
    rows = 1
    times = 1
    ! the command itself is called ROWS: the option is the one after it
    call rec%check_options([character(5) :: 'side', 'rows', 'times', 'from', 'to'], log)
    call read_row_count(rec, rows, log)
    call rec%integer_option('times', times, log)
    if (rows < 1 .or. times < 0 .or. times > 20) then
      call rec%add_error(log, 'ROWS is positive, TIMEs is 0 to 20', 'Write ROWS SIDE=top ROWS=2 TIMEs=1')
      return
    end if
    call rows_at_side(mesh, side, rows, lo, hi)
    along = 3 - (side + 1)/2
    call rec%number_option('from', lo(along), log)
    call rec%number_option('to', hi(along), log)
    call split_box(mesh, lo, hi, along, times, halved)
    if (times > 0 .and. halved == 0) call nothing_to_split(rec, log)
  end subroutine read_rows

  subroutine read_row_count(rec, rows, log)
    type(record), intent(inout) :: rec
    integer, intent(inout) :: rows
    type(message_log), intent(inout) :: log
    integer :: i

    do i = 2, rec%count - 1
      if (rec%key(i) == 'rows') call rec%integer(i + 1, rows, log, 'number of rows')
    end do
  end subroutine read_row_count

  subroutine read_split(rec, mesh, log)
    type(record), intent(inout) :: rec
    type(t_mesh_type), intent(inout) :: mesh
    type(message_log), intent(inout) :: log
    integer :: d, times, halved
    real(wp) :: box(4)

    if (rec%key(2) /= 'para') then
      call rec%add_error(log, 'where to split is missing', 'Write SPLIt PARAmeter s1 s2 t1 t2 DIRection=d')
      return
    end if
    call rec%check_options([character(9) :: 'direction', 'times'], log)
    call rec%numbers(3, box, log, 'bounds')
    d = 0
    times = 1
    call rec%integer_option('direction', d, log)
    call rec%integer_option('times', times, log)
    if (d < 1 .or. d > 2 .or. times < 0 .or. times > 20) then
      call rec%add_error(log, 'DIRection is 1 or 2, TIMEs is 0 to 20', 'Write DIRection=1: lines across direction 1')
      return
    end if
    call split_box(mesh, box([1, 3]), box([2, 4]), d, times, halved)
    if (times > 0 .and. halved == 0) call nothing_to_split(rec, log)
  end subroutine read_split

  subroutine nothing_to_split(rec, log)
    type(record), intent(in) :: rec
    type(message_log), intent(inout) :: log

    call rec%add_error(log, 'there is nothing to split there', &
      'No element overlaps the bounds; they come in pairs, the smaller one first')
  end subroutine nothing_to_split

  subroutine read_sweep(rec, ndm, sweep, log)
    type(record), intent(inout) :: rec
    integer, intent(in) :: ndm
    type(sweep_type), allocatable, intent(inout) :: sweep
    type(message_log), intent(inout) :: log
    real(wp) :: vector(3), ratio
    real(wp), allocatable :: breaks(:)
    integer :: degree, n, status

    if (ndm /= 3) then
      call rec%add_error(log, 'SWEEp makes a solid: the model has two dimensions', 'Remove it, or set ndm to 3')
      return
    end if
    if (allocated(sweep)) then
      call rec%add_error(log, 'the surface is swept already', 'One SWEEp makes a solid')
      return
    end if
    call rec%check_options([character(8) :: 'degree', 'elements', 'ratio'], log)
    call rec%numbers(2, vector, log, 'components of the vector')
    degree = 1
    n = 1
    ratio = 1
    call rec%integer_option('degree', degree, log)
    call rec%integer_option('elements', n, log)
    call rec%number_option('ratio', ratio, log)
    if (degree < 1 .or. degree > 20 .or. n < 1 .or. .not. ratio > 0 .or. .not. norm2(vector) > 0) then
      call rec%add_error(log, 'a sweep has a vector, a degree of 1 to 20, elements and a positive ratio', &
        'Write SWEEp 0 0 1 DEGRee=3 ELEMents=4')
      return
    end if
    sweep = straight_sweep(vector)
    call elevate_sweep(sweep, degree - 1)
    breaks = graded_breaks(0.0_wp, 1.0_wp, n, ratio)
    if (abs(ratio - 1) <= 0) breaks = uniform_breaks(0.0_wp, 1.0_wp, n)
    call refine_sweep(sweep, breaks(2:n), status)
    if (status /= ok) call rec%add_error(log, status_text(status), 'Grade less')
  end subroutine read_sweep

  subroutine report_suitability(command, mesh, log)
    !! A mesh whose T-junctions' extensions cross is refused: its functions may be dependent.
    type(record), intent(in) :: command
    type(t_mesh_type), intent(in) :: mesh
    type(message_log), intent(inout) :: log
    type(crossing_type) :: crossing
    integer :: status

    call check_suitability(mesh, status, crossing)
    if (status == ok) return
    call command%add_error(log, 'the T-mesh is not analysis-suitable: the extensions of the T-junctions at ' &
      //place(crossing%first)//' and '//place(crossing%second)//' cross at '//place(crossing%at), &
      'Add SUITable as the last refinement, or use REFIne')
  end subroutine report_suitability

  function place(x) result(text)
    real(wp), intent(in) :: x(2)
    character(:), allocatable :: text
    text = '('//write_number(x(1))//', '//write_number(x(2))//')'
  end function place
end module t_patch_lines
