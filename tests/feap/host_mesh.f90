module host_mesh
  !! The mesh part of a deck, read twice: to count, then to store. Commands of FEAP that the decks of inputs/feap use, and
  !! the user mesh commands.
  use feap_items, only: item_list, split_record, read_items
  use host_deck, only: deck_unit, at_end
  use host_memory, only: reserve_real, reserve_integer, forget_all
  implicit none
  private
  public :: read_mesh, material_element, material_history, call_element

  integer, parameter :: most_materials = 20
  character(4) :: mesh_command(6)
  character(15) :: element_name(4)
  integer :: material_element(most_materials) = 0    !! number of the elmtNN
  integer :: material_history(most_materials) = 0    !! words of a history

contains

  subroutine read_mesh()
    include 'cdata.h'
    include 'sdata.h'
    include 'umac1.h'
    include 'dstars.h'
    include 'comfil.h'
    integer :: i, no_nodes(1)
    character(15) :: tx(8)
    real(8) :: td(9)
    logical :: bad
    logical, external :: tinput

    do i = 1, 4
      utx(1) = 'user'
      call call_element(i, td, td, td, no_nodes, td, td, td, 1, 1, 1, -1)
      element_name(i) = utx(1)
    end do
    do i = 1, 6
      write (uct, '(a,i1)') 'mes', i
      call user_mesh(i, tx)
      mesh_command(i) = uct
    end do

    bad = tinput(tx, 1, td, 0)
    if (bad .or. record(1:4) /= 'FEAP') error stop 'host: the deck does not begin with FEAP'
    bad = tinput(tx, 0, td, 9)
    numnp = nint(td(1))
    numel = nint(td(2))
    nummat = nint(td(3))
    ndm = nint(td(4))
    ndf = nint(td(5))
    nen = nint(td(6))
    starnd = 0
    starel = 0
    ucount = .true.
    call pass_over()
    rewind (deck_unit)
    bad = tinput(tx, 0, td, 0)
    bad = tinput(tx, 0, td, 0)
    ucount = .false.
    nen1 = nen + 11
    nst = nen*ndf
    nneq = ndf*numnp
    call reserve_arrays()
    call pass_over()
  end subroutine read_mesh

  subroutine reserve_arrays()
    include 'cdata.h'
    include 'sdata.h'
    include 'pointer.h'
    include 'comblk.h'
    include 'hdata.h'

    call forget_all()
    call reserve_real(43, ndm*numnp)         ! coordinates
    call reserve_real(27, 2*nneq)            ! forces, prescribed displacements
    call reserve_real(40, 3*nneq)            ! displacement, increments of step and iteration
    call reserve_real(26, nneq)              ! residual
    call reserve_real(50, 1000)              ! history of the element at hand, t_n ...
    call reserve_real(51, 1000)              ! ... and t_n+1
    call reserve_integer(33, nen1*numel)     ! nodes, material, ...
    call reserve_integer(31, 2*nneq)         ! equations, boundary codes
    call reserve_integer(29, nneq)           ! time function of each dof
    call reserve_integer(190, numnp)         ! types of nodes
    call reserve_integer(34, 7*nst)
    call reserve_integer(21, nneq)           ! profile
    nh1 = np(50)
    nh2 = np(51)
  end subroutine reserve_arrays

  subroutine pass_over()
    !! All commands to END.
    include 'cdata.h'
    include 'sdata.h'
    include 'umac1.h'
    include 'dstars.h'
    include 'pointer.h'
    include 'comblk.h'
    type(item_list) :: items
    character(15) :: tx(8)
    integer :: i, j
    real(8) :: td(9)
    logical :: bad
    logical, external :: tinput

    do
      bad = tinput(tx, 1, td, 0)
      if (at_end .or. bad) error stop 'host: END is missing'
      call split_record_of(items)
      if (items%n == 0) cycle
      select case (items%key(1))
      case ('end ')
        return
      case ('coor')
        call read_nodal(items, 43, 0, ndm)
      case ('elem')
        call read_elements()
      case ('boun')
        call read_codes(items)
      case ('forc')
        call read_nodal(items, 27, 0, ndf)
      case ('disp')
        call read_nodal(items, 27, ndf*numnp, ndf)
      case ('ebou', 'edis', 'epro')
        call read_edges(items%key(1))
      case ('mate')
        i = items%whole(2)
        nummat = max(nummat, i)
        call read_material(i)
      case default
        do j = 1, 6
          if (items%key(1) /= mesh_command(j)) cycle
          uct = mesh_command(j)
          unumnd = 0
          unumel = 0
          call user_mesh(j, tx)
          if (ucount) numnp = max(numnp, unumnd + starnd)
          if (ucount) numel = max(numel, unumel + starel)
          exit
        end do
        if (j > 6) then
          print '(2a)', ' host: unknown mesh command: ', items%line
          error stop
        end if
      end select
    end do
  end subroutine pass_over

  subroutine split_record_of(items)
    type(item_list), intent(out) :: items
    include 'comfil.h'

    call split_record(record, items)
  end subroutine split_record_of

  subroutine read_nodal(command, slot, shift, n)
    !! Records `node ng values`; nodes between have values between.
    type(item_list), intent(in) :: command
    integer, intent(in) :: slot, shift, n    !! FEAP's pointer, beginning behind it, values of a node
    include 'cdata.h'
    include 'umac1.h'
    include 'pointer.h'
    include 'comblk.h'
    type(item_list) :: items
    real(8) :: values(n), last(n)
    integer :: node, ng, last_node, last_ng, i, k

    last_ng = 0
    last_node = 0
    do
      call read_items(items)
      if (items%n == 0) exit
      node = items%whole(1)
      ng = items%whole(2)
      do i = 1, n
        values(i) = items%number(2 + i)
      end do
      if (ucount) then
        if (command%key(1) == 'coor') numnp = max(numnp, node)
        cycle
      end if
      if (last_ng > 0) then
        do k = last_node + last_ng, node - 1, last_ng
          do i = 1, n
            hr(np(slot) + shift + n*(k - 1) + i - 1) = last(i) + (values(i) - last(i))*(k - last_node)/(node - last_node)
          end do
        end do
      end if
      do i = 1, n
        hr(np(slot) + shift + n*(node - 1) + i - 1) = values(i)
      end do
      last_node = node
      last_ng = ng
      last = values
    end do
  end subroutine read_nodal

  subroutine read_elements()
    !! Records `element ng material nodes`, without generation.
    use feap_arrays, only: store_element
    include 'cdata.h'
    include 'umac1.h'
    type(item_list) :: items
    integer :: i

    do
      call read_items(items)
      if (items%n == 0) exit
      numel = max(numel, items%whole(1))
      if (ucount) nen = max(nen, items%n - 3)
      if (.not. ucount) call store_element(items%whole(1), items%whole(3), [(items%whole(i), i=4, items%n)])
    end do
  end subroutine read_elements

  subroutine read_codes(command)
    !! Records `node ng codes`; negative codes hold for the nodes up to the next record.
    type(item_list), intent(in) :: command
    include 'cdata.h'
    include 'sdata.h'
    include 'umac1.h'
    include 'pointer.h'
    include 'comblk.h'
    type(item_list) :: items
    integer :: codes(6), last(6), node, ng, last_node, last_ng, i, k

    last_ng = 0
    last_node = 0
    last = 0
    do
      call read_items(items)
      if (items%n == 0 .or. len(command%line) == 0) exit
      if (ucount) cycle
      node = items%whole(1)
      ng = items%whole(2)
      do i = 1, ndf
        codes(i) = items%whole(2 + i)
      end do
      if (last_ng > 0 .and. any(last(1:ndf) < 0)) then
        do k = last_node + last_ng, node - 1, last_ng
          do i = 1, ndf
            if (last(i) < 0) mr(np(31) + nneq + ndf*(k - 1) + i - 1) = 1
          end do
        end do
      end if
      do i = 1, ndf
        mr(np(31) + nneq + ndf*(node - 1) + i - 1) = codes(i)
      end do
      last_node = node
      last_ng = ng
      last = codes
    end do
  end subroutine read_codes

  subroutine read_edges(key)
    !! Records `direction coordinate values`: all nodes there, once the mesh stands.
    character(4), intent(in) :: key
    include 'cdata.h'
    include 'sdata.h'
    include 'umac1.h'
    include 'pointer.h'
    include 'comblk.h'
    type(item_list) :: items
    integer :: n, i, direction
    integer(8) :: at

    do
      call read_items(items)
      if (items%n == 0) exit
      if (ucount) cycle
      direction = items%whole(1)
      do n = 1, numnp
        if (abs(hr(np(43) + ndm*(n - 1) + direction - 1) - items%number(2)) > 1.0d-7) cycle
        do i = 1, ndf
          at = ndf*(n - 1) + i - 1
          select case (key)
          case ('ebou')
            if (items%whole(2 + i) /= 0) mr(np(31) + nneq + at) = 1
          case ('edis'); hr(np(27) + nneq + at) = hr(np(27) + nneq + at) + items%number(2 + i)
          case ('epro'); mr(np(29) + at) = items%whole(2 + i)
          end select
        end do
      end do
    end do
  end subroutine read_edges

  subroutine read_material(number)
    integer, intent(in) :: number
    include 'cdata.h'
    include 'sdata.h'
    include 'eldata.h'
    include 'hdata.h'
    include 'umac1.h'
    type(item_list) :: items
    integer, allocatable :: lie(:)
    real(8) :: d(10), none(1)
    integer :: i
    logical, external :: pcomp

    call read_items(items)
    if (ucount) then                         ! the property lines mean nothing yet
      do while (items%n > 0)
        call read_items(items)
      end do
      return
    end if
    do i = 1, size(element_name)
      if (pcomp(items%text(1)//repeat(' ', 15), element_name(i), 15)) exit
    end do
    if (i > size(element_name)) error stop 'host: unknown element'
    material_element(number) = i
    ma = number
    nh1 = 0
    pstyp = ndm
    allocate (lie(ndf*(nen + 1)), source=1)
    call call_element(i, d, none, none, lie, none, none, none, ndf, ndm, nst, 1)
    material_history(number) = int(nh1)
    call reset_history()
  end subroutine read_material

  subroutine reset_history()
    include 'hdata.h'
    include 'pointer.h'

    nh1 = np(50)
    nh2 = np(51)
  end subroutine reset_history

  subroutine user_mesh(i, tx)
    integer, intent(in) :: i
    character(15), intent(in) :: tx(*)
    external :: umesh1, umesh2, umesh3, umesh4, umesh5, umesh6

    select case (i)
    case (1); call umesh1(tx, .false.)
    case (2); call umesh2(tx, .false.)
    case (3); call umesh3(tx, .false.)
    case (4); call umesh4(tx, .false.)
    case (5); call umesh5(tx, .false.)
    case (6); call umesh6(tx, .false.)
    end select
  end subroutine user_mesh

  subroutine call_element(i, d, ul, xl, ix, tl, s, p, ndf, ndm, nst, isw)
    integer, intent(in) :: i                 !! number of the elmtNN
    integer, intent(in) :: ndf, ndm, nst, isw
    real(8) :: d(*), ul(*), xl(*), tl(*), s(*), p(*)
    integer :: ix(*)
    external :: elmt01, elmt02, elmt03, host_solid

    if (isw >= 3) then
      s(1:nst*nst) = 0
      p(1:nst) = 0
    end if
    select case (i)
    case (1); call elmt01(d, ul, xl, ix, tl, s, p, ndf, ndm, nst, isw)
    case (2); call elmt02(d, ul, xl, ix, tl, s, p, ndf, ndm, nst, isw)
    case (3); call elmt03(d, ul, xl, ix, tl, s, p, ndf, ndm, nst, isw)
    case (4); call host_solid(d, ul, xl, ix, tl, s, p, ndf, ndm, nst, isw)
    end select
  end subroutine call_element
end module host_mesh
